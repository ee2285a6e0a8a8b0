// Pictures of a camera that is a node of ROS 2.
#include "common/ros2/nodes/nodes.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/time_between.hpp"
#include "common/ros2/nodes/topic_queue.hpp"
#include "common/ros2/pictures.hpp"
#include "services/recognition/cameras/raw_picture.hpp"
#include "services/recognition/cameras/sources.hpp"
#include "services/recognition/files/picture_file.hpp"

namespace prehend::recognition {
namespace {

using std::chrono::seconds;

constexpr Duration max_wait = seconds(3);  // for a picture
constexpr Duration max_age = seconds(1);   // of a stamp that is believed
constexpr const char* compressed = "/compressed";
constexpr double tolerated = 0.01;  // of a lens, beside lab.toml

/// Cameras tell their pictures with and without asking whether they have come.
dds::RawTopic heard_on(const std::string& topic, const char* type) {
  dds::RawTopic made = ros2::topic_of_nodes(topic, type);
  made.qos.reliable = false;
  return made;
}

/// Beside the pictures: /a/image/compressed and /a/image_raw have /a/camera_info.
std::string info_topic(const std::string& pictures) {
  std::string image = pictures;
  if (image.ends_with(compressed)) image.resize(image.size() - std::string_view(compressed).size());
  const auto space = image.rfind('/');
  return (space == std::string::npos ? "" : image.substr(0, space + 1)) + "camera_info";
}

class NodeCamera final : public Camera {
 public:
  NodeCamera(dds::Participant nodes, std::string topic, const CameraModel& model)
      : nodes_(std::move(nodes)), topic_(std::move(topic)), model_(model) {}

  Expected<void> listen() {
    auto pictures = ros2::TopicQueue::create(
        nodes_, heard_on(topic_, is_raw() ? "sensor_msgs/Image" : "sensor_msgs/CompressedImage"),
        1);
    if (!pictures) return tl::unexpected(pictures.error());
    pictures_ = std::move(*pictures);
    auto lenses =
        ros2::TopicQueue::create(nodes_, heard_on(info_topic(topic_), "sensor_msgs/CameraInfo"), 1);
    if (!lenses) return tl::unexpected(lenses.error());
    lenses_ = std::move(*lenses);
    return {};
  }

  Expected<Picture> next() override {
    const auto message = pictures_->next(max_wait);
    if (!message)
      return fail("no pictures come", "/" + topic_,
                  "does the camera's node run? ros2 topic hz, and ROS_DOMAIN_ID of both");
    if (const auto lens = lenses_->next({})) compare(lens->payload);
    return is_raw() ? taken(ros2::parse_image(message->payload), picture_of)
                    : taken(ros2::parse_compressed_image(message->payload),
                            [](const ros2::CompressedPicture& picture, const std::string& where) {
                              return decode_picture(picture.data, where);
                            });
  }
  bool paces_itself() const override { return true; }
  Duration age() const override { return age_; }

 private:
  /// As drivers and image_transport name their topics.
  bool is_raw() const { return !topic_.ends_with(compressed); }

  template <class Message, class Decode>
  Expected<Picture> taken(const Expected<Message>& message, const Decode& decode) {
    const std::string where = "/" + topic_;
    if (!message) return fail(message.error().what, where, message.error().hint);
    const Time now = process_now(), stamp = from_ns(message->stamp_ns);
    age_ = stamp <= now && is_within(stamp, now, max_age) ? between(stamp, now) : Duration{};
    return decode(*message, where);
  }

  /// Objects are placed by lab.toml: where that is another lens, it is said once.
  void compare(std::span<const std::uint8_t> message) {
    if (compared_) return;
    const auto lens = ros2::parse_camera_info(message);
    compared_ = true;
    if (!lens) return log::warning(lens.error());
    const double scale = model_.width > 0 ? static_cast<double>(lens->width) / model_.width : 0;
    const auto differs = [&](double said, double known) {
      return std::abs(said - scale * known) > tolerated * scale * model_.width;
    };
    if (!differs(lens->fx, model_.focal.x()) && !differs(lens->fy, model_.focal.y()) &&
        !differs(lens->cx, model_.centre.x()) && !differs(lens->cy, model_.centre.y()))
      return;
    log::warning(
        "the camera says that its lens is another one than in lab.toml, by which objects are "
        "placed; its values: camera.width = {}, camera.height = {}, camera.focal = [{:.1f}, "
        "{:.1f}], camera.centre = [{:.1f}, {:.1f}], camera.distortion = [{:.5g}]",
        lens->width, lens->height, lens->fx, lens->fy, lens->cx, lens->cy,
        fmt::join(lens->distortion, ", "));
  }

  dds::Participant nodes_;
  std::string topic_;
  CameraModel model_;
  std::unique_ptr<ros2::TopicQueue> pictures_, lenses_;
  Duration age_{};
  bool compared_ = false;
};

}  // namespace

Expected<std::unique_ptr<Camera>> open_nodes(const CameraOptions& options) {
  const auto domain = ros2::domain_of_nodes();
  if (!domain) return tl::unexpected(domain.error());
  auto nodes = ros2::join_nodes("prehend_camera", *domain, options.network);
  if (!nodes) return tl::unexpected(nodes.error());
  std::string topic = options.path.empty() ? "camera/image/compressed" : options.path;
  if (topic.starts_with('/')) topic.erase(0, 1);
  auto camera = std::make_unique<NodeCamera>(std::move(*nodes), std::move(topic), options.model);
  if (auto listens = camera->listen(); !listens) return tl::unexpected(listens.error());
  return camera;
}

}  // namespace prehend::recognition
