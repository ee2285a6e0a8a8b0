// The bytes of a message for ROS 2 are what its type in idl/ros2 says.
#include "services/ros/core/messages.hpp"

#include <gtest/gtest.h>

#include "common/recording/types/idl.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::ros {
namespace {

using recording::types::Value;

Value decoded(const std::string& type, const Bytes& bytes) {
  static const auto types = recording::types::load_idl(PREHEND_SOURCE "/idl/ros2").value();
  const auto* structure = types.find(type);
  if (!structure) throw std::runtime_error("no type " + type);
  auto value = recording::types::decode(*structure, bytes);
  if (!value) throw std::runtime_error(value.error().message());
  return *value;
}

const Value& in(const Value& value, std::initializer_list<const char*> path) {
  const Value* at = &value;
  for (const char* field : path) {
    at = at->find(field);
    if (!at) throw std::runtime_error(std::string("no field ") + field);
  }
  return *at;
}
double number(const Value& value) {
  return std::get<double>(value.content);
}

// As a node of ROS 2 writes std_msgs/String "ab": header, length with the zero, text.
TEST(RosMessages, ATextIsTheBytesThatNodesWrite) {
  EXPECT_EQ(text_message("ab"), (Bytes{0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0}));
}

TEST(RosMessages, JointsAreReadAsTheirTypeSays) {
  const Bytes bytes = joint_state({.stamp_ns = -1,
                                   .frame = "palm",
                                   .names = {"a", "bcdef", ""},
                                   .positions = {0.5, -1, 2},
                                   .velocities = {},
                                   .efforts = {1, 2, 3}});
  const Value state = decoded("sensor_msgs::msg::dds_::JointState_", bytes);
  // Before 1970 the seconds are negative, what is added never is.
  EXPECT_EQ(std::get<std::int64_t>(in(state, {"header_", "stamp_", "sec_"}).content), -1);
  EXPECT_EQ(std::get<std::uint64_t>(in(state, {"header_", "stamp_", "nanosec_"}).content),
            999'999'999U);
  EXPECT_EQ(std::get<std::string>(in(state, {"header_", "frame_id_"}).content), "palm");
  const auto& names = std::get<Value::List>(in(state, {"name_"}).content);
  ASSERT_EQ(names.size(), 3U);
  EXPECT_EQ(std::get<std::string>(names[1].content), "bcdef");
  const auto& positions = std::get<Value::List>(in(state, {"position_"}).content);
  ASSERT_EQ(positions.size(), 3U);
  EXPECT_EQ(number(positions[1]), -1);
  EXPECT_TRUE(std::get<Value::List>(in(state, {"velocity_"}).content).empty());
  EXPECT_EQ(number(std::get<Value::List>(in(state, {"effort_"}).content)[2]), 3);
}

// From the table along its parents, each link stands where the kinematics put it.
TEST(RosMessages, LinksHangTogether) {
  const auto model = model::HandModel::load(PREHEND_SOURCE "/common/models/hands/barrett").value();
  const Eigen::VectorXd joints = model.joint_angles(model.postures().at("open").array() + 0.3);
  const Pose X_WB = make_pose(Eigen::Vector3d(1, 2, 3), Eigen::Quaterniond(0.6, 0.8, 0, 0));
  const auto transforms = transforms_of(model, X_WB, joints, "table", 5);
  ASSERT_EQ(transforms.size(), model.links().size());
  const auto X_BL = model.link_poses(joints);
  std::map<std::string, Pose> X_W{{"table", Pose::Identity()}};
  const Value message = decoded("tf2_msgs::msg::dds_::TFMessage_", tf_message(transforms));
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
