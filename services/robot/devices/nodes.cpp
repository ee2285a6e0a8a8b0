#include "services/robot/devices/nodes.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "common/base/clock.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/ros2/nodes/topic_queue.hpp"

namespace prehend::robot {
namespace {

constexpr std::size_t kept = 64;  // messages that nobody has read yet

/// In the controller's namespace. Who tells much needs no answer for each: it is read in the way
/// that matches writers of both kinds.
dds::RawTopic joint_states(const std::string& controller, bool read) {
  const auto space = controller.rfind('/');
  dds::RawTopic topic = ros2::topic_of_nodes(
      (space == std::string::npos ? "" : controller.substr(0, space + 1)) + "joint_states",
      "sensor_msgs/JointState");
  topic.qos.reliable = !read;
  return topic;
}

dds::RawTopic trajectories(const std::string& controller) {
  return ros2::topic_of_nodes(controller + "/joint_trajectory", "trajectory_msgs/JointTrajectory");
}

}  // namespace

struct Nodes::State {
  explicit State(dds::Participant joined) : participant(std::move(joined)) {}

  dds::Participant participant;
  std::optional<dds::RawWriter> writer;
  std::unique_ptr<ros2::TopicQueue> heard;
};

Nodes::Nodes(std::unique_ptr<State> state) : state_(std::move(state)) {}
Nodes::~Nodes() = default;

Expected<std::unique_ptr<Nodes>> Nodes::join(const NodesOptions& options, End end) {
  const bool drives = end == End::driver;
  auto joined = ros2::join_nodes(drives ? "prehend_robot" : "prehend_emulated_controller",
                                 options.domain, options.network);
  if (!joined) return tl::unexpected(joined.error());
  auto state = std::make_unique<State>(std::move(*joined));
  auto writer =
      dds::RawWriter::create(state->participant, drives ? trajectories(options.controller)
                                                        : joint_states(options.controller, false));
  if (!writer) return tl::unexpected(writer.error());
  state->writer.emplace(std::move(*writer));
  auto heard = ros2::TopicQueue::create(
      state->participant,
      drives ? joint_states(options.controller, true) : trajectories(options.controller), kept);
  if (!heard) return tl::unexpected(heard.error());
  state->heard = std::move(*heard);
  return std::unique_ptr<Nodes>(new Nodes(std::move(state)));
}

std::string Nodes::read(Duration timeout) {
  const auto message = state_->heard->next(timeout);
  return message ? std::string(message->payload.begin(), message->payload.end()) : std::string();
}

Expected<void> Nodes::write(std::string_view message) {
  dds::RawSample sample;
  sample.payload.assign(message.begin(), message.end());
  if (!state_->writer->write(sample, process_now()))
    return fail("a message to nodes could not be sent");
  return {};
}

Expected<std::unique_ptr<serial::Plug>> plug_into_nodes(const NodesOptions& options) {
  class NodesPlug final : public serial::Plug {
   public:
    NodesPlug(std::unique_ptr<Nodes> nodes, std::string where)
        : nodes_(std::move(nodes)), where_(std::move(where)) {}
    std::string read(Duration timeout) override { return nodes_->read(timeout); }
    void write(std::string_view message) override { (void)nodes_->write(message); }
    std::string where() const override { return where_; }

   private:
    std::unique_ptr<Nodes> nodes_;
    std::string where_;
  };
  auto nodes = Nodes::join(options, Nodes::End::controller);
  if (!nodes) return tl::unexpected(nodes.error());
  return std::make_unique<NodesPlug>(
      std::move(*nodes),
      fmt::format("/{}/joint_trajectory, domain {}", options.controller, options.domain));
}

}  // namespace prehend::robot
