#include "services/robot/devices/nodes.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "common/base/clock.hpp"
#include "common/ros2/nodes/nodes.hpp"

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

  void keep(dds::RawSample&& sample) {
    if (sample.kind != dds::RawSample::Kind::data) return;
    const std::scoped_lock lock(mutex);
    if (heard.size() == kept) heard.pop_front();
    heard.emplace_back(sample.payload.begin(), sample.payload.end());
    come.notify_one();
  }

  dds::Participant participant;
  std::mutex mutex;  // guards heard
  std::condition_variable come;
  std::deque<std::string> heard;
  std::optional<dds::RawWriter> writer;
  std::unique_ptr<dds::RawReader> reader;  // ends first: what it receives goes into heard
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
  auto reader = dds::RawReader::create(
      state->participant,
      drives ? joint_states(options.controller, true) : trajectories(options.controller),
      [kept_in = state.get()](dds::RawSample&& sample) { kept_in->keep(std::move(sample)); });
  if (!reader) return tl::unexpected(reader.error());
  state->reader = std::move(*reader);
  return std::unique_ptr<Nodes>(new Nodes(std::move(state)));
}

std::string Nodes::read(Duration timeout) {
  std::unique_lock lock(state_->mutex);
  if (!state_->come.wait_for(lock, timeout, [this] { return !state_->heard.empty(); })) return {};
  std::string message = std::move(state_->heard.front());
  state_->heard.pop_front();
  return message;
}

Expected<void> Nodes::write(std::string_view message) {
  dds::RawSample sample;
  sample.payload.assign(message.begin(), message.end());
  if (!state_->writer->write(sample, process_now())) return fail("could not be sent");
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
