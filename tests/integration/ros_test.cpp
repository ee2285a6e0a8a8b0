// What nodes of ROS 2 hear, by a reader of another make: the hand's joints and links, its
// description, objects and the camera.
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/file_text.hpp"
#include "common/convert/convert.hpp"
#include "common/model/hand_model.hpp"
#include "common/ros2/nodes/type_hash.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

class Ros : public Rig {
 protected:
  stage::Process start_with(const std::string& name, const Strings& arguments,
                            const std::map<std::string, std::string>& environment) {
    stage::Process::Options options;
    options.command = {program(name)};
    options.command.insert(options.command.end(), arguments.begin(), arguments.end());
    options.log = folder_ / (name + ".log");
    options.output = folder_ / (name + ".out");
    options.environment = environment;
    auto made = stage::Process::start(options);
    if (!made) throw std::runtime_error(made.error().message());
    return std::move(*made);
  }
  std::string said(const std::string& name) const {
    return read_file(folder_ / (name + ".out")).value_or("");
  }
};

v1::HandState state_of(const model::HandModel& model) {
  v1::HandState state;
  state.hand("hand");
  state.model(model.name().c_str());
  state.stamp_ns(1'700'000'000'250'000'000);
  const Eigen::VectorXd joint = model.joint_angles(model.postures().at("open").array() + 0.2);
  state.joint(convert::to_message(joint));
  state.velocity(std::vector<double>(model.joints().size(), 0.5));
  state.torque(std::vector<double>(model.joints().size(), 0.25));
  state.X_WB(convert::to_message(make_pose(Eigen::Vector3d(0.1, 0.2, 0.3))));
  return state;
}

/// Seven numbers behind the names of its parent and itself, in a line that begins with «frame».
struct Frame {
  std::string parent;
  Pose X;
};
std::map<std::string, Frame> frames_in(const std::string& text) {
  std::map<std::string, Frame> found;
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string word, parent, child;
    double x, y, z, qx, qy, qz, qw;
    if (words >> word >> parent >> child >> x >> y >> z >> qx >> qy >> qz >> qw && word == "frame")
      found[child] = {parent,
                      make_pose(Eigen::Vector3d(x, y, z), Eigen::Quaterniond(qw, qx, qy, qz))};
  }
  return found;
}

v1::ObjectDetection a_cup() {
  v1::ObjectDetection seen;
  seen.track(3);
  seen.stamp_ns(1'700'000'000'000'000'000);
  seen.name("Cup");
  seen.shape(v1::SHAPE_CYLINDER);
  seen.size(convert::to_message(Eigen::Vector3d(0.04, 0.04, 0.1)));
  seen.X_WO(convert::to_message(make_pose(Eigen::Vector3d(0.25, 0, 0.05))));
  seen.probability(0.5);
  return seen;
}

v1::GraspReport a_grasp() {
  v1::GraspReport report;
  report.hand("hand");
  report.held(false);
  report.reason("slipped");
  return report;
}

v1::CameraImage a_picture() {
  v1::CameraImage picture;
  picture.camera("camera");
  picture.encoding("jpeg");
  picture.data({1, 2, 3, 4, 5});
  return picture;
}

/// Each writer says of its type what nodes since Iron look for.
void expect_announced(const std::string& heard) {
  for (const auto& [topic, type] : std::map<std::string, std::string>{
           {"joint_states", "sensor_msgs/JointState"},
           {"robot_description", "std_msgs/String"},
           {"tf", "tf2_msgs/TFMessage"},
           {"tf_static", "tf2_msgs/TFMessage"},
           {"detections", "vision_msgs/Detection3DArray"},
           {"diagnostics", "diagnostic_msgs/DiagnosticArray"},
           {"camera/image/compressed", "sensor_msgs/CompressedImage"},
           {"camera/camera_info", "sensor_msgs/CameraInfo"}})
    EXPECT_NE(
        heard.find("announced rt/" + topic + " " + std::string(ros2::announced_hash(type)) + "\n"),
        std::string::npos)
        << topic << "\n"
        << heard;
}

void expect_joints(const std::string& heard, const model::HandModel& model,
                   const v1::HandState& state) {
  std::istringstream first(heard.substr(heard.find("joints ")));
  std::string word, frame;
  std::int64_t sec = 0, nanosec = 0;
  first >> word >> sec >> nanosec >> frame;
  EXPECT_EQ(sec, 1'700'000'000);
  EXPECT_EQ(nanosec, 250'000'000);
  EXPECT_EQ(frame, model.links()[0].name);
  for (std::size_t i = 0; i < model.joints().size(); ++i) {
    first >> word;
    EXPECT_TRUE(word.starts_with(model.joints()[i].name + "=")) << word;
    EXPECT_TRUE(word.ends_with("/0.5/0.25")) << word;
    EXPECT_NEAR(std::stod(word.substr(word.find('=') + 1)), state.joint()[i], 1e-8) << word;
  }
}

void expect_frames(const std::string& heard, const model::HandModel& model,
                   const v1::HandState& state) {
  const auto frames = frames_in(heard);
  ASSERT_EQ(frames.size(), 4U) << heard;
  EXPECT_EQ(frames.at(model.links()[0].name).parent, "table");
  EXPECT_TRUE(
      frames.at(model.links()[0].name).X.isApprox(make_pose(Eigen::Vector3d(0.1, 0.2, 0.3)), 1e-8));
  const model::HandJoint& last =
      model.joints().at(static_cast<std::size_t>(model.links().back().joint));
  const double angle = state.joint()[static_cast<std::size_t>(model.links().back().joint)];
  EXPECT_EQ(frames.at(model.links().back().name).parent,
            model.links()[static_cast<std::size_t>(last.parent)].name);
  // The joint's frame, turned about its axis; nine digits were printed.
  EXPECT_TRUE(frames.at(model.links().back().name)
                  .X.isApprox(last.X_PJ * Pose(Eigen::AngleAxisd(angle, last.axis_J)), 1e-7));
  EXPECT_EQ(frames.at("object/Talc").parent, "table");
  EXPECT_TRUE(frames.at("object/Talc").X.isApprox(make_pose(Eigen::Vector3d(1, 2, 3)), 1e-8));
}

TEST_F(Ros, NodesHearTheHandWithoutABridge) {
  const auto model = model::HandModel::load(model::hand_directory("barrett")).value();
  auto states = writer(dds::robot_state);
  auto objects = writer(dds::object_state);
  auto seen = writer(dds::object_detection);
  auto grasps = writer(dds::grasp_report);
  auto pictures = writer(dds::camera_image);
  const test::DomainLease other;  // than the lab's
  const int nodes = other.domain();
  auto bridge =
      start_with("prehend-ros", lab_arguments({}), {{"ROS_DOMAIN_ID", std::to_string(nodes)}});
  meet(states);
  meet(objects);
  seen.write(a_cup());
  const std::string tip = model.links().back().name;
  auto node =
      start_with("cyclone_ros_reader",
                 {std::to_string(nodes), model.links()[0].name, tip, "object/Talc", "camera"}, {});
  const v1::HandState state = state_of(model);
  v1::ObjectState object;
  object.body("Talc");
  object.X_WO(convert::to_message(make_pose(Eigen::Vector3d(1, 2, 3))));
  std::optional<stage::Process::Exit> end;
  ASSERT_TRUE(eventually(40, [&] {
    states.write(state);
    objects.write(object);
    grasps.write(a_grasp());
    pictures.write(a_picture());
    seen.write(a_cup());
    return (end = node.exit()).has_value();
  }));
  const std::string heard = said("cyclone_ros_reader");
  EXPECT_EQ(end->code, 0) << heard;

  expect_joints(heard, model, state);
  const auto urdf = read_file(model::hand_directory("barrett") / "hand.urdf");
  ASSERT_TRUE(urdf);
  EXPECT_NE(heard.find("description " + std::to_string(urdf->size()) + "\n"), std::string::npos);

  for (const char* line :
       {"detections 1 Cup=0.25/0.1\n", "diagnostics 1 prehend: grasp of hand: slipped\n",
        "picture camera jpeg 5\n", "lens 640 480 620\n"})
    EXPECT_NE(heard.find(line), std::string::npos) << line << heard;
  expect_announced(heard);

  expect_frames(heard, model, state);
  bridge.signal(SIGTERM);
  const auto exit = bridge.wait(seconds(20));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0);
}

TEST_F(Ros, ADomainThatIsNoneIsWrongUse) {
  for (const char* domain : {"233", "-1", "1x"}) {
    auto process = start_with("prehend-ros", lab_arguments({}), {{"ROS_DOMAIN_ID", domain}});
    const auto exit = process.wait(seconds(20));
    ASSERT_TRUE(exit);
    EXPECT_EQ(exit->code, 2) << domain;
  }
}

}  // namespace
}  // namespace prehend::integration
