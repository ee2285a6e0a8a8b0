// A trajectory that a node of ROS 2 has written until the gate of the simulation has accepted the
// command that follows it, over two DDS hops and three processes: a node, prehend-ros-lead and
// prehend-simulation. The floor are raw Fast DDS processes that do nothing but pass messages of the
// same types, over the same two hops, with the same QoS, in the same run: the same node, one that
// writes an empty command for each trajectory, and one that hears it. Both run side by side in
// slices. Nodes have a domain of their own, and are on this machine, with keys in the lab or
// without.
//
// Each trajectory has one point, to be reached at once: the command that is measured has its
// positions.
//
//   benchmark_ros_lead [--json] [--seconds S] [--rate HZ]... [--case laptop|secure]...
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "common/model/hand_model.hpp"
#include "common/ros2/joints.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "tests/benchmark/hops.hpp"

namespace prehend {
namespace {

using hops::Case;
using hops::Place;

/// The domain of nodes is that of the environment, as ROS 2 has it.
dds::Participant join_nodes(const char* name) {
  return ros2::join_nodes(name, ros2::domain_of_nodes().value(), "laptop").value();
}

dds::RawTopic trajectories() {
  return ros2::topic_of_nodes("joint_trajectory", "trajectory_msgs/JointTrajectory");
}

/// First, of floor and lab: trajectories at the given rate, of a hand that opens and closes a
/// little.
int node(double rate) {
  const auto hand = model::HandModel::load(model::hand_directory(model::lab_hand())).value();
  auto participant = join_nodes("node");
  auto writer = dds::RawWriter::create(participant, trajectories()).value();
  ros2::JointTrajectory trajectory;
  for (const model::HandDof& dof : hand.dofs())
    trajectory.names.push_back(hand.joints()[static_cast<std::size_t>(dof.joint)].name);
  auto& point = trajectory.points.emplace_back();
  dds::RawSample sample;
  double t = 0;
  hops::at_rate(rate, [&] {
    t += 1 / rate;
    Eigen::VectorXd dof = hand.postures().at("open");
    for (Eigen::Index d = 0; d < dof.size(); ++d) {
      const model::HandDof& range = hand.dofs()[static_cast<std::size_t>(d)];
      dof[d] += 0.05 * (1 - std::cos(t)) * (0.5 * (range.lower + range.upper) - dof[d]);
    }
    point.positions.assign(dof.begin(), dof.end());
    const ros2::Bytes bytes = ros2::joint_trajectory(trajectory);
    sample.payload.assign(bytes.begin(), bytes.end());
    writer.write(sample, hops::now());
  });
  return 0;
}

/// Second, of the floor: a command for every trajectory.
int floor_relay(const Place& place) {
  auto nodes = join_nodes("floor-relay");
  auto participant = hops::join(place, "floor-relay", "performer");
  auto writer = *participant.writer(dds::robot_command);
  v2::HandCommand command;
  command.hand("hand");
  command.dof(std::vector<double>(4));
  const auto reader = dds::RawReader::create(nodes, trajectories(), [&](dds::RawSample&& sample) {
                        command.stamp_ns(to_ns(sample.received));
                        command.origin_ns(to_ns(sample.sent));
                        writer.write(command);
                      }).value();
  hops::wait_for_the_end();
  return 0;
}

std::vector<stage::Process> start_floor(const Case& at, const Place& place, double rate) {
  std::vector<stage::Process> started;
  started.push_back(at.start("", hops::floor_command("relay", rate, place)));
  started.push_back(at.start("", hops::floor_command("node", rate, place)));
  return started;
}

std::vector<stage::Process> start_lab(const Case& at, const Place& place, double rate) {
  std::vector<stage::Process> started;
  started.push_back(at.start_service("ros-lead", place, {}));
  started.push_back(at.start("", hops::floor_command("node", rate, place)));
  return started;
}

/// Between two trajectories a tick may command, too, so twice as many commands are enough.
std::uint64_t accepted(double rate, std::size_t wanted) {
  return static_cast<std::uint64_t>(2 * (rate + static_cast<double>(wanted)));
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (const auto floor = hops::floor_of(argc, argv))
    return floor->role == "node" ? node(floor->rate) : floor_relay(floor->place);
  const test::DomainLease nodes;
  ::setenv("ROS_DOMAIN_ID", std::to_string(nodes.domain()).c_str(), 1);
  hops::measure(
      hops::plan_of(argc, argv, {.seconds = 10, .rates = {100}, .cases = {"laptop", "secure"}}),
      start_floor, start_lab, accepted);
  return 0;
}
