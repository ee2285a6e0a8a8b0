#include "services/console/core/documents.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace prehend::console {
namespace {

constexpr std::int64_t second = 1'000'000'000;  // ns

}  // namespace

Json to_time(std::int64_t ns) {
  const std::int64_t whole = ns < 0 ? 0 : ns;
  return {{"sec", whole / second}, {"nsec", whole % second}};
}

Json to_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

namespace {

Json rotation_of(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

}  // namespace

Json to_json(const Pose& X) {
  return {{"position", to_json(Eigen::Vector3d(X.translation()))}, {"orientation", rotation_of(X)}};
}

Json to_json(const Colour& colour) {
  return {{"r", colour.r}, {"g", colour.g}, {"b", colour.b}, {"a", colour.a}};
}

std::pair<std::string, std::string> around(const FeedInfo& feed) {
  if (feed.list.empty()) return {};
  return {"{\"" + std::string(feed.list) + "\":[", "]}"};
}

namespace {

void add_value(std::string& text, std::int64_t value) {
  std::array<char, 24> digits;
  text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr);
}

/// Nine digits are nanometres on a table. What is not finite has no JSON.
void add_value(std::string& text, double value) {
  std::array<char, 32> digits;
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  text.append(
      digits.data(),
      std::to_chars(digits.begin(), digits.end(), value, std::chars_format::general, 9).ptr);
}

/// Names of frames are those of messages: whatever they are, they stay one string.
void add_value(std::string& text, std::string_view name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return c >= 0x20 && c < 0x7f && c != '"' && c != '\\';
  });
  if (!plain) {
    text += text_of(Json(name));
    return;
  }
  text += '"';
  text += name;
  text += '"';
}

}  // namespace

void add_transform(std::string& list, std::int64_t ns, std::string_view a, std::string_view b,
                   const Pose& X_AB) {
  const Eigen::Vector3d p = X_AB.translation();
  const Eigen::Quaterniond q(X_AB.linear());
  const std::int64_t since = std::max<std::int64_t>(ns, 0);
  if (!list.empty()) list += ',';
  const auto field = [&](std::string_view before, const auto& value) {
    list += before;
    add_value(list, value);
  };
  field("{\"timestamp\":{\"sec\":", since / second);
  field(",\"nsec\":", since % second);
  field("},\"parent_frame_id\":", a);
  field(",\"child_frame_id\":", b);
  field(",\"translation\":{\"x\":", p.x());
  field(",\"y\":", p.y());
  field(",\"z\":", p.z());
  field("},\"rotation\":{\"x\":", q.x());
  field(",\"y\":", q.y());
  field(",\"z\":", q.z());
  field(",\"w\":", q.w());
  list += "}}";
}

Json entity(std::int64_t ns, std::string_view id, std::string_view frame) {
  Json made{{"timestamp", to_time(ns)},
            {"frame_id", frame},
            {"id", id},
            {"lifetime", to_time(0)},
            {"frame_locked", true}};
  for (const char* list : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"})
    made[list] = Json::array();
  return made;
}

void add_shape(Json& entity, const model::Shape& shape, const Pose& X_ES, const Colour& colour) {
  const Eigen::Vector3d size = 2 * model::half_extents(shape);
  Json solid{{"pose", to_json(X_ES)}, {"size", to_json(size)}};
  const char* list = "cubes";
  if (shape.kind == model::ShapeKind::sphere) list = "spheres";
  if (model::is_upright_round(shape.kind)) {
    list = "cylinders";  // Foxglove's: as wide as the size says, times the scale of each end
    const double widest = 0.5 * size.x();
    solid["bottom_scale"] = model::radius_at(shape, -0.5 * size.z()) / widest;
    solid["top_scale"] = model::radius_at(shape, 0.5 * size.z()) / widest;
  }
  solid["color"] = to_json(colour);
  entity[list].push_back(std::move(solid));
}

void add_ellipsoid(Json& entity, const Eigen::Vector3d& half, const Pose& X_ES,
                   const Colour& colour) {
  entity["spheres"].push_back({{"pose", to_json(X_ES)},
                               {"size", to_json(Eigen::Vector3d(2 * half))},
                               {"color", to_json(colour)}});
}

void add_arrow(Json& entity, const Eigen::Vector3d& from, const Eigen::Vector3d& along,
               double thickness, const Colour& colour) {
  // An arrow points along x of its pose.
  const Pose X = make_pose(
      from, Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), along).normalized());
  const double length = along.norm(), head = std::min(0.01, length / 2);
  entity["arrows"].push_back({{"pose", to_json(X)},
                              {"shaft_length", length - head},
                              {"shaft_diameter", thickness},
                              {"head_length", head},
                              {"head_diameter", 2.5 * thickness},
                              {"color", to_json(colour)}});
}

void add_line(Json& entity, const std::vector<Eigen::Vector3d>& points, const Colour& colour) {
  Json listed = Json::array();
  for (const Eigen::Vector3d& point : points) listed.push_back(to_json(point));
  entity["lines"].push_back({{"type", 0},  // a strip
                             {"pose", to_json(Pose::Identity())},
                             {"thickness", 0.003},
                             {"scale_invariant", false},
                             {"points", std::move(listed)},
                             {"color", to_json(colour)},
                             {"colors", Json::array()},
                             {"indices", Json::array()}});
}

void add_cone(Json& entity, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double angle,
              const Colour& colour) {
  constexpr double side = 0.025;  // m
  constexpr int sides = 16;
  const Eigen::Vector3d back = -axis.normalized();
  const Eigen::Vector3d across = back.unitOrthogonal();
  const auto rim = [&](int i) -> Eigen::Vector3d {
    const Eigen::Vector3d out = Eigen::AngleAxisd(2 * EIGEN_PI * i / sides, back) * across;
    return tip + side * (std::cos(angle) * back + std::sin(angle) * out);
  };
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < sides; ++i) corners.insert(corners.end(), {tip, rim(i), rim(i + 1)});
  add_triangles(entity, corners, colour);
}

void add_triangles(Json& entity, const std::vector<Eigen::Vector3d>& corners,
                   const Colour& colour) {
  Json points = Json::array();
  for (const Eigen::Vector3d& corner : corners) points.push_back(to_json(corner));
  entity["triangles"].push_back({{"pose", to_json(Pose::Identity())},
                                 {"points", std::move(points)},
                                 {"color", to_json(colour)},
                                 {"colors", Json::array()},
                                 {"indices", Json::array()}});
}

void add_text(Json& entity, const Eigen::Vector3d& at, std::string_view text,
              const Colour& colour) {
  entity["texts"].push_back({{"pose", to_json(make_pose(at))},
                             {"billboard", true},
                             {"font_size", 14.0},
                             {"scale_invariant", true},
                             {"color", to_json(colour)},
                             {"text", text}});
}

Json scene_with(Json entity) {
  return {{"deletions", Json::array()}, {"entities", Json::array({std::move(entity)})}};
}

Json scene_without(std::int64_t ns, std::string_view id) {
  return {{"deletions", Json::array({{{"timestamp", to_time(ns)}, {"type", 0}, {"id", id}}})},
          {"entities", Json::array()}};
}

Json log_line(std::int64_t ns, LogLevel level, std::string_view name, std::string_view message) {
  return {{"timestamp", to_time(ns)},
          {"level", static_cast<int>(level)},
          {"message", message},
          {"name", name},
          {"file", ""},
          {"line", 0}};
}

std::string text_of(const Json& document) {
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace prehend::console
