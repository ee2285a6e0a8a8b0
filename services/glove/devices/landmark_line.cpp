#include "services/glove/devices/landmark_line.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "services/glove/core/frame.hpp"

namespace prehend::glove {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

constexpr double farthest = 5;  // m

/// Where landmark i of 21 stands among WebXR's 25: each finger has its metacarpal before it.
std::size_t webxr_index(std::size_t i) {
  return i < 5 ? i : i + (i - 1) / 4;
}

/// Whether the line's buttons can be meant; they are put into it.
bool take_buttons(const Json& buttons, LandmarkLine& line) {
  if (buttons.is_null()) return true;
  if (!buttons.is_array() || buttons.size() > max_buttons) return false;
  line.held.emplace();
  for (const Json& button : buttons) {
    if (!button.is_number_unsigned()) return false;
    const auto number = button.get<std::uint64_t>();
    if (number < 1 || number > max_buttons) return false;
    line.held->push_back(static_cast<std::uint8_t>(number));
  }
  return true;
}

}  // namespace

tl::expected<LandmarkLine, std::string_view> parse_landmarks(std::string_view text) {
  const auto refuse = [](std::string_view reason) { return tl::unexpected(reason); };
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return refuse("unreadable");
  const auto field = [&](const char* name) -> const Json& {
    static const Json none;
    const auto found = json.find(name);
    return found == json.end() ? none : *found;
  };
  if (field("version") != landmark_line_version) return refuse("unknown version");
  LandmarkLine line;
  const Json &hand = field("hand"), &origin = field("origin"), &points = field("points_m");
  line.left = hand == "left";
  line.in_room = origin == "room";
  if ((!line.left && hand != "right") || (!line.in_room && origin != "hand") || !points.is_array())
    return refuse("unreadable");
  if (const Json& stamp = field("stamp_s"); !stamp.is_null()) {
    if (!stamp.is_number()) return refuse("unreadable");
    line.stamp = stamp.get<double>();
    // Beyond, nanoseconds since 1970 do not fit into what the messages have for them.
    if (!(std::abs(*line.stamp) < 9e9)) return refuse("out of range");
  }
  if (!take_buttons(field("buttons"), line)) return refuse("unreadable");
  if (points.size() != 21 && points.size() != 25) return refuse("wrong count");
  const bool webxr = points.size() == 25;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Json& point = points[webxr ? webxr_index(i) : i];
    if (!point.is_array() || point.size() != 3) return refuse("unreadable");
    for (std::size_t k = 0; k < 3; ++k) {
      // What is not finite has no number in JSON; programs write null.
      if (!point[k].is_number()) return refuse(point[k].is_null() ? "not finite" : "unreadable");
      line.points[i][static_cast<Eigen::Index>(k)] = point[k].get<double>();
    }
    if (!line.points[i].allFinite()) return refuse("not finite");
    if (line.points[i].norm() > farthest) return refuse("out of range");
  }
  return line;
}

std::string to_line(const LandmarkLine& line, bool webxr) {
  const auto list = [](const Vector3d& p) { return Json{p.x(), p.y(), p.z()}; };
  Json json{{"version", landmark_line_version}};
  if (line.stamp) json["stamp_s"] = *line.stamp;
  json["hand"] = line.left ? "left" : "right";
  json["origin"] = line.in_room ? "room" : "hand";
  Json points = Json::array();
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    if (webxr && i >= 5 && i % 4 == 1)
      points.push_back(list((line.points[0] + line.points[i]) / 2));
    points.push_back(list(line.points[i]));
  }
  json["points_m"] = std::move(points);
  if (line.held) json["buttons"] = *line.held;
  return json.dump();
}

}  // namespace prehend::glove
