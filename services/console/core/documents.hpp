#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

/// Parts of the JSON documents that bear Foxglove's schema names. Every field of a schema is there,
/// since viewers want it so; times are {sec, nsec}.
namespace prehend::console {

using Json = nlohmann::ordered_json;

/// What a document is about, in the order of the channels.
enum class Feed : std::uint8_t {
  tf,
  scene,
  image,
  annotations,
  report,
  status,
  latency,
  log,
  reply,
  signals,
  training
};

/// A feed as a channel: its topic, and the schema that it bears.
struct FeedInfo {
  Feed feed;
  std::string_view topic;
  std::string_view schema_name;
  /// Each message counts, not the newest of each key alone.
  bool queued = false;
  /// Not empty: a document is some elements of this list, the only field of a message.
  std::string_view list = {};
};
inline constexpr std::array<FeedInfo, 11> feeds{{
    {Feed::tf, "/tf", "foxglove.FrameTransforms", false, "transforms"},
    {Feed::scene, "/scene", "foxglove.SceneUpdate"},
    {Feed::image, "/camera/image", "foxglove.CompressedImage"},
    {Feed::annotations, "/camera/annotations", "foxglove.ImageAnnotations"},
    {Feed::report, "/grasp/report", "prehend.GraspReport", true},
    {Feed::status, "/status", "prehend.Status"},
    {Feed::latency, "/latency", "prehend.Latency"},
    {Feed::log, "/log", "foxglove.Log", true},
    {Feed::reply, "/operator/reply", "prehend.OperatorReply", true},
    {Feed::signals, "/signals", "prehend.Signals"},
    {Feed::training, "/training", "prehend.Training"},
}};
/// The JSON schema of a feed's messages, as text.
std::string json_schema(Feed feed);
/// What stands before and behind the elements of a feed's list; empty where it has none.
std::pair<std::string, std::string> around(const FeedInfo& feed);

struct Colour {
  double r = 0, g = 0, b = 0, a = 1;
};

enum class LogLevel : std::uint8_t { debug = 1, info, warning, error };

Json to_time(std::int64_t ns);
Json to_json(const Eigen::Vector3d& v);
Json to_json(const Pose& X);
Json to_json(const Colour& colour);

/// X_AB, where A and B are names of frames, as one more element of a list. Written as text, since
/// most of what is told are these.
void add_transform(std::string& list, std::int64_t ns, std::string_view a, std::string_view b,
                   const Pose& X_AB);

/// An entity of a scene with nothing in it yet.
Json entity(std::int64_t ns, std::string_view id, std::string_view frame);
/// Adds a solid to an entity. E: the entity's frame, S: the shape's.
void add_shape(Json& entity, const model::Shape& shape, const Pose& X_ES, const Colour& colour);
/// half: its axes, in its own frame S.
void add_ellipsoid(Json& entity, const Eigen::Vector3d& half, const Pose& X_ES,
                   const Colour& colour);
void add_arrow(Json& entity, const Eigen::Vector3d& from, const Eigen::Vector3d& along,
               double thickness, const Colour& colour);
void add_line(Json& entity, const std::vector<Eigen::Vector3d>& points, const Colour& colour);
/// The friction cone of a contact: its tip is there, and it opens against the axis. angle: half of
/// its opening, rad.
void add_cone(Json& entity, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double angle,
              const Colour& colour);
/// Three corners a triangle.
void add_triangles(Json& entity, const std::vector<Eigen::Vector3d>& corners, const Colour& colour);
void add_text(Json& entity, const Eigen::Vector3d& at, std::string_view text, const Colour& colour);
/// A scene update with one entity, or with the end of one.
Json scene_with(Json entity);
Json scene_without(std::int64_t ns, std::string_view id);

Json log_line(std::int64_t ns, LogLevel level, std::string_view name, std::string_view message);

/// As text. What is no UTF-8 is replaced.
std::string text_of(const Json& document);

}  // namespace prehend::console
