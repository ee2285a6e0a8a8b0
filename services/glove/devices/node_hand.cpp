#include "services/glove/devices/node_hand.hpp"

#include <span>
#include <utility>

#include "common/base/clock.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/ros2/nodes/topic_queue.hpp"
#include "common/ros2/poses.hpp"
#include "services/glove/devices/hand_feed.hpp"

namespace prehend::glove {
namespace {

constexpr std::size_t kept = 8;  // pictures that were not read yet

std::string name_of(const DeviceOptions& options) {
  const std::string name = options.port.empty() ? node_hand_topic : options.port;
  return name.starts_with('/') ? name.substr(1) : name;
}

/// Trackers tell with and without asking whether it has come.
dds::RawTopic topic_of(const DeviceOptions& options, bool read) {
  dds::RawTopic made = ros2::topic_of_nodes(name_of(options), "geometry_msgs/PoseArray");
  made.qos.reliable = !read;
  return made;
}

Expected<dds::Participant> join(const DeviceOptions& options, const char* name) {
  const auto domain = ros2::domain_of_nodes();
  if (!domain) return tl::unexpected(domain.error());
  return ros2::join_nodes(name, *domain, options.network);
}

class NodeFeed final : public HandFeed {
 public:
  NodeFeed(dds::Participant nodes, bool left) : nodes_(std::move(nodes)), left_(left) {}
  Expected<void> listen(const dds::RawTopic& topic) {
    auto queue = ros2::TopicQueue::create(nodes_, topic, kept);
    if (!queue) return tl::unexpected(queue.error());
    queue_ = std::move(*queue);
    return {};
  }

  Expected<Came> read(Duration timeout) override {
    const auto message = queue_->next(timeout);
    if (!message) return Came{};
    return Came{.hands = {hand_in(message->payload)}};
  }

 private:
  tl::expected<LandmarkLine, std::string_view> hand_in(std::span<const std::uint8_t> bytes) const {
    const auto told = ros2::parse_pose_array(bytes);
    if (!told) return tl::unexpected(std::string_view("unreadable"));
    LandmarkLine line{.left = left_, .in_room = true};
    if (told->stamp_ns != 0) line.stamp = 1e-9 * static_cast<double>(told->stamp_ns);
    const auto points = landmarks_among(told->points, left_);
    if (!points) return tl::unexpected(points.error());
    line.points = *points;
    return line;
  }

  dds::Participant nodes_;
  bool left_;
  std::unique_ptr<ros2::TopicQueue> queue_;
};

class NodeHandEmulator final : public Emulator {
 public:
  explicit NodeHandEmulator(const DeviceOptions& options) : teller_(options) {}
  std::string receive(std::string_view, Duration) override { return {}; }
  std::vector<std::string> measure(const Frame& frame, Duration) override {
    const auto line = teller_.tell(frame);
    if (!line) return {};
    const auto bytes = ros2::pose_array(
        {.frame = "tracker", .points = {line->points.begin(), line->points.end()}});
    return {std::string(bytes.begin(), bytes.end())};
  }

 private:
  HandTeller teller_;
};

class NodeHandPlug final : public serial::Plug {
 public:
  NodeHandPlug(dds::Participant nodes, dds::RawWriter writer, std::string where)
      : nodes_(std::move(nodes)), writer_(std::move(writer)), where_(std::move(where)) {}
  std::string read(Duration) override { return {}; }
  void write(std::string_view message) override {
    dds::RawSample sample;
    sample.payload.assign(message.begin(), message.end());
    writer_.write(sample, process_now());
  }
  std::string where() const override { return where_; }

 private:
  dds::Participant nodes_;
  dds::RawWriter writer_;
  std::string where_;
};

}  // namespace

Expected<std::unique_ptr<Device>> create_node_hand(const DeviceOptions& options) {
  if (const auto domain = ros2::domain_of_nodes(); !domain) return tl::unexpected(domain.error());
  return make_bare_hand(
      options, {.open = [options]() -> Expected<std::unique_ptr<HandFeed>> {
                  auto nodes = join(options, "prehend_hand");
                  if (!nodes) return tl::unexpected(nodes.error());
                  auto feed = std::make_unique<NodeFeed>(std::move(*nodes), options.left);
                  const auto listens = feed->listen(topic_of(options, true));
                  if (!listens) return tl::unexpected(listens.error());
                  return feed;
                },
                .where = "/" + name_of(options),
                .advice = "start the tracker's node; ros2 topic hz shows whether it tells"});
}

std::unique_ptr<Emulator> emulate_node_hand(const DeviceOptions& options) {
  return std::make_unique<NodeHandEmulator>(options);
}

Expected<std::unique_ptr<serial::Plug>> plug_into_node_hand(const DeviceOptions& options) {
  auto nodes = join(options, "prehend_emulated_hand");
  if (!nodes) return tl::unexpected(nodes.error());
  auto writer = dds::RawWriter::create(*nodes, topic_of(options, false));
  if (!writer) return tl::unexpected(writer.error());
  return std::make_unique<NodeHandPlug>(std::move(*nodes), std::move(*writer),
                                        "/" + name_of(options));
}

}  // namespace prehend::glove
