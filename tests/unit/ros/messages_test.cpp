// The bytes of a message for ROS 2 are what its type in idl/ros2 says.
#include "services/ros/core/messages.hpp"

#include <gtest/gtest.h>

#include "tests/support/paths/paths.hpp"
#include "tests/support/ros_values.hpp"

namespace prehend::ros {
namespace {

using test::in;
using test::number;
using test::ros_value;
using test::Value;

// As a node of ROS 2 writes std_msgs/String "ab": header, length with the zero, text.
TEST(RosMessages, ATextIsTheBytesThatNodesWrite) {
  EXPECT_EQ(text_message("ab"), (Bytes{0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0}));
}

// From the table along its parents, each link stands where the kinematics put it.
TEST(RosMessages, LinksHangTogether) {
  const auto model =
      model::HandModel::load(test::in_sources("common/models/hands/barrett")).value();
  const Eigen::VectorXd joints = model.joint_angles(model.postures().at("open").array() + 0.3);
  const Pose X_WB = make_pose(Eigen::Vector3d(1, 2, 3), Eigen::Quaterniond(0.6, 0.8, 0, 0));
  const auto transforms = transforms_of(model, X_WB, joints, "table", 5);
  ASSERT_EQ(transforms.size(), model.links().size());
  const auto X_BL = model.link_poses(joints);
  std::map<std::string, Pose> X_W{{"table", Pose::Identity()}};
  const Value message = ros_value("tf2_msgs::msg::dds_::TFMessage_", tf_message(transforms));
  for (const Value& t : std::get<Value::List>(in(message, {"transforms_"}).content)) {
    const auto text = [&](std::initializer_list<const char*> path) {
      return std::get<std::string>(in(t, path).content);
    };
    const auto of = [&](const char* part, const char* field) {
      return number(in(t, {"transform_", part, field}));
    };
    const Pose X_PC = make_pose(Eigen::Vector3d(of("translation_", "x_"), of("translation_", "y_"),
                                                of("translation_", "z_")),
                                Eigen::Quaterniond(of("rotation_", "w_"), of("rotation_", "x_"),
                                                   of("rotation_", "y_"), of("rotation_", "z_")));
    X_W[text({"child_frame_id_"})] = X_W.at(text({"header_", "frame_id_"})) * X_PC;
  }
  for (std::size_t i = 0; i < X_BL.size(); ++i)
    EXPECT_TRUE(X_W.at(model.links()[i].name).isApprox(X_WB * X_BL[i], 1e-12));
}

}  // namespace
}  // namespace prehend::ros
