// Damaged messages of nodes of ROS 2: whatever comes, what is read fits itself, a driver of a
// controller is never ready without sound positions, and no node leads a hand out of its range.
#include <cmath>

#include "common/ros2/joints.hpp"
#include "common/ros2/poses.hpp"
#include "services/robot/core/ros2_control_driver.hpp"
#include "services/robot/core/ros2_control_emulator.hpp"
#include "services/ros/core/trajectory_follower.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::robot;

namespace {

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("parallel_jaw"));
  return *loaded;
}

std::string state() {
  return ros2_control::Emulator(hand(), {}).pass(std::chrono::milliseconds(20));
}

std::string trajectory() {
  ros2_control::Driver driver(hand(), {});
  driver.connected(from_ns(0));
  (void)driver.step(state(), from_ns(1'000'000));
  driver.follow(hand().postures().at("open"), {}, from_ns(1'000'000));
  return driver.step({}, from_ns(20'000'000));
}

std::string pose() {
  const auto bytes = ros2::pose_stamped({.stamp_ns = 7, .frame = "table"});
  return {bytes.begin(), bytes.end()};
}

/// Whatever is followed stays near the hand's ranges.
void follow(const ros2::JointTrajectory& trajectory) {
  const Time now = from_ns(1'000'000'000);
  ros::TrajectoryFollower follower(hand());
  if (!follower.take(trajectory, hand().postures().at("open"), now)) return;
  for (const double after : {0.0, 0.001, 0.01, 1.0, 1e9}) {
    const auto goal = follower.goal(now + seconds(after));
    if (!goal) continue;
    const model::HandDof& dof = hand().dofs()[0];
    const double over = ((*goal) - hand().clamp(*goal)).cwiseAbs().maxCoeff();
    fuzz::require(goal->allFinite() && over <= 0.011 * (dof.upper - dof.lower),
                  "a node leads the hand out of its range");
  }
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {state(), trajectory(), pose()};
  fuzzer.mutate = [](Random& r, std::string message) { return fuzz::mutate_bytes(r, message); };
  fuzzer.target = [](const std::string& input) {
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
    const auto joints = ros2::parse_joint_state(bytes);
    const auto told = ros2::parse_joint_trajectory(bytes);
    if (joints) fuzz::require(joints->positions.size() == joints->names.size(), "joints missing");
    if (told)
      for (const auto& point : told->points)
        fuzz::require(point.positions.size() == told->names.size(), "a point without joints");
    if (told) follow(*told);
    const auto place = ros2::parse_pose_stamped(bytes);
    if (place) fuzz::require(is_finite(place->X_FB), "a base that is nowhere");
    ros2_control::Driver driver(hand(), {});
    ros2_control::Emulator robot(hand(), {});
    driver.connected(from_ns(0));
    (void)driver.step(input, from_ns(1'000'000));
    if (driver.phase() == Phase::ready)
      fuzz::require(driver.reading() && driver.reading()->dof.allFinite(), "ready, but nowhere");
    (void)robot.receive(input, Duration::zero());
    (void)robot.pass(std::chrono::milliseconds(50));
    fuzz::require(robot.measured().allFinite(), "the emulated hand is nowhere");
    return joints.has_value() || told.has_value() || place.has_value();
  };
  return fuzz::run(fuzzer, argc, argv);
}
