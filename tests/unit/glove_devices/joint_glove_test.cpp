// The joint-angle glove's driver against the emulated one, with and without a tracker on the wrist.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/serial/pseudo_terminal.hpp"
#include "services/glove/devices/joint_emulator.hpp"
#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

using testing::EmulatedDevice;
using testing::Listener;
using testing::StillHand;

std::string link_path(const char* name) {
  return (std::filesystem::temp_directory_path() /
          ("prehend_joint_" + std::to_string(::getpid()) + name))
      .string();
}

/// A half closed hand somewhere, as sensors and as joints.
Frame half_closed() {
  const model::HumanPosture q = model::HumanHand::posture({0.5, 0.5, 0.5, 0.5, 0.5});
  Frame frame;
  frame.readings.push_back({Site::back_of_hand,
                            true,
                            {0.1, -0.3, 0.2},
                            Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()))});
  frame.joint_angles.assign(q.begin(), q.end());
  return frame;
}

std::unique_ptr<Device> make(const DeviceOptions& options) {
  auto made = find_device("joint_glove")->create(options);
  EXPECT_TRUE(made) << made.error().message();
  return std::move(*made);
}

EmulationOptions emulation(const char* kind, const DeviceOptions& options,
                           const std::string& link) {
  EmulationOptions made = emulation_of(*find_device(kind), options, link);
  made.rate = 100;
  return made;
}

TEST(JointGlove, GivesJointAnglesOfBothGloves) {
  for (const std::size_t sensors : {18u, 22u}) {
    DeviceOptions options;
    options.port = link_path("both");
    options.joint_gains = *typical_gains(sensors);
    options.scene.X_WH = make_pose({0, 0, 0.25});
    const StillHand hand(half_closed());
    const EmulatedDevice glove(emulation("joint_glove", options, options.port), hand);
    Listener listener;
    const auto device = make(options);
    device->start(listener.sink());
    ASSERT_TRUE(listener.frames(10));
    const Frame frame = listener.all().back();
    ASSERT_EQ(frame.joint_angles.size(), 20u);
    // A count is up to 0.0266 rad; 18 sensors do not measure the distal joints.
    for (std::size_t dof = 0; dof < 20; ++dof) {
      const bool distal = dof < 16 && dof % 4 == 3;
      if (dof == 4 || (distal && sensors == 18)) continue;
      EXPECT_NEAR(frame.joint_angles[dof], half_closed().joint_angles[dof], 0.0134) << dof;
    }
    // Nothing measures the wrist: the hand stays where the scene has it.
    ASSERT_EQ(frame.readings.size(), 1u);
    EXPECT_EQ(frame.readings[0].site, Site::back_of_hand);
    EXPECT_LT((frame.readings[0].p_TS - Eigen::Vector3d(0, 0, 0.25)).norm(), 1e-12);
  }
}

TEST(JointGlove, TakesTheHandFromATracker) {
  DeviceOptions options;
  options.port = link_path("glove");
  options.wrist_port = link_path("wrist");
  options.rate = 50;
  DeviceOptions one = options;
  one.sites = {Site::back_of_hand};
  const StillHand hand(half_closed());
  const EmulatedDevice glove(emulation("joint_glove", options, options.port), hand);
  Listener listener;
  const auto device = make(options);
  {
    const EmulatedDevice tracker(emulation("nest_of_birds", one, options.wrist_port), hand);
    device->start(listener.sink());
    ASSERT_TRUE(listener.frame_with([](const Frame& f) { return f.readings[0].valid; }));
    ASSERT_TRUE(listener.frames(5));
    const Reading back = listener.all().back().readings[0];
    EXPECT_LT((back.p_TS - half_closed().readings[0].p_TS).norm(), 3e-4);
    EXPECT_LT(back.q_TS.angularDistance(half_closed().readings[0].q_TS), 1e-3);
  }
  // The tracker has gone: fingers go on, the hand's place is not valid any more.
  const std::size_t before = listener.all().size();
  ASSERT_TRUE(listener.says(options.wrist_port));
  ASSERT_TRUE(listener.frames(20));
  EXPECT_FALSE(listener.all().back().readings[0].valid);
  EXPECT_GT(listener.all().size(), before);
}

// The scene says where the right hand is that a left one becomes; only a tracker's pose is
// mirrored.
TEST(JointGlove, MirrorsALeftHandsTracker) {
  DeviceOptions options;
  options.left = true;
  options.port = link_path("left");
  options.scene.X_WH = make_pose({0.2, 0, 0.25});
  const StillHand hand(half_closed());
  const EmulatedDevice glove(emulation("joint_glove", options, options.port), hand);
  {
    Listener listener;
    const auto device = make(options);
    device->start(listener.sink());
    ASSERT_TRUE(listener.frames(3));
    const Frame frame = listener.all().back();
    EXPECT_TRUE(frame.left);
    EXPECT_LT((frame.readings[0].p_TS - Eigen::Vector3d(0.2, 0, 0.25)).norm(), 1e-12);
  }
  options.wrist_port = link_path("leftwrist");
  DeviceOptions one = options;
  one.sites = {Site::back_of_hand};
  const EmulatedDevice tracker(emulation("nest_of_birds", one, options.wrist_port), hand);
  Listener listener;
  const auto device = make(options);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frame_with([](const Frame& f) { return f.readings[0].valid; }));
  const Frame frame = listener.all().back();
  EXPECT_TRUE(frame.left);
  EXPECT_LT((frame.readings[0].p_TS - Eigen::Vector3d(-0.1, -0.3, 0.2)).norm(), 3e-4);
  EXPECT_NEAR(frame.joint_angles[1], half_closed().joint_angles[1], 0.0134);
}

TEST(JointGlove, SaysWhenItHasAnotherNumberOfSensors) {
  DeviceOptions options;
  options.port = link_path("twenty");
  auto line = serial::PseudoTerminal::open(options.port);
  ASSERT_TRUE(line) << line.error().message();
  Listener listener;
  const auto device = make(options);
  device->start(listener.sink());
  std::string asked;
  for (int n = 0; n < 1000 && asked.find("?S") == std::string::npos; ++n)
    asked += line->read(std::chrono::milliseconds(10));
  line->write(std::string("?S\x14\0", 4));
  EXPECT_TRUE(listener.says("the glove says that it has 20 sensors (18 and 22 are known)"));
}

TEST(JointGlove, RefusesAWrongConfiguration) {
  const auto kind = find_device("joint_glove");
  DeviceOptions options;
  EXPECT_FALSE(kind->create(options)) << "no port";
  options.port = "/dev/ttyUSB0";
  EXPECT_TRUE(kind->create(options)) << "need not be there yet";
  options.rate = 1000;
  EXPECT_FALSE(kind->create(options));
  options.rate = 100;
  options.joint_gains = {{1, 2}, {3}};
  EXPECT_FALSE(kind->create(options));
  options.baud = 300;
  EXPECT_EQ(kind->create(options).error().message(),
            "glove.baud: the glove knows 2400 to 115200 bits per second");
}

}  // namespace
}  // namespace prehend::glove
