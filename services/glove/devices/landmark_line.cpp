#include "services/glove/devices/landmark_line.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/glove/core/frame.hpp"
#include "services/glove/core/held_controller.hpp"
#include "services/glove/core/plausible_hand.hpp"

namespace prehend::glove {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

constexpr double farthest = 5;          // m
constexpr std::size_t max_joints = 26;  // of OpenXR

/// Where landmark i of 21 stands among WebXR's 25: each finger has its metacarpal before it.
std::size_t webxr_index(std::size_t i) {
  return i < 5 ? i : i + (i - 1) / 4;
}

/// OpenXR's 26 are those of WebXR behind the palm.
std::size_t place_of(std::size_t i, std::size_t count) {
  return count == 21 ? i : webxr_index(i) + (count == 26 ? 1 : 0);
}

/// "Right", as some trackers write it, is right.
std::string small_letters(const Json& word) {
  if (!word.is_string()) return {};
  auto text = word.get<std::string>();
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// s since 1970 of a time in s, ms, µs or ns, of which only one lies between 2001 and 2100; any
/// other number stays.
double in_seconds(double stamp) {
  constexpr double from = 1e9, until = 4.2e9;
  for (const double unit : {1e-3, 1e-6, 1e-9})
    if (stamp * unit >= from && stamp * unit <= until) return stamp * unit;
  return stamp;
}

/// Python writes what is not finite as NaN and Infinity, which is no JSON.
bool has_no_number(std::string_view text) {
  return text.find("NaN") != std::string_view::npos ||
         text.find("Infinity") != std::string_view::npos;
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

using Refusable = tl::expected<Landmarks, std::string_view>;

tl::unexpected<std::string_view> refuse(std::string_view reason) {
  return tl::unexpected(reason);
}

/// So many finite numbers; else why not.
template <int Count>
tl::expected<Eigen::Matrix<double, Count, 1>, std::string_view> numbers_in(const Json& list) {
  Eigen::Matrix<double, Count, 1> made;
  if (!list.is_array() || list.size() != Count) return refuse("unreadable");
  for (int k = 0; k < Count; ++k) {
    // What is not finite has no number in JSON; programs write null.
    const Json& number = list[static_cast<std::size_t>(k)];
    if (!number.is_number()) return refuse(number.is_null() ? "not finite" : "unreadable");
    made[k] = number.get<double>();
  }
  return made;
}

Refusable points_in(const Json& points, bool left) {
  std::vector<Vector3d> joints;
  for (std::size_t i = 0; i < std::min<std::size_t>(points.size(), max_joints + 1); ++i) {
    const auto point = numbers_in<3>(points[i]);
    if (!point) return tl::unexpected(point.error());
    joints.push_back(*point);
  }
  return landmarks_among(joints, left);
}

Refusable hand_on(const Json& controller, bool left) {
  const auto pressed = [&](const char* name) {
    const Json value = controller.value(name, Json());
    return value.is_number() ? value.get<double>() : -1;
  };
  const auto position = numbers_in<3>(controller.value("position_m", Json()));
  const auto turned = numbers_in<4>(controller.value("orientation", Json()));
  if (!position || !turned) return tl::unexpected(position ? turned.error() : position.error());
  const double trigger = pressed("trigger"), grip = pressed("grip");
  if (!(trigger >= 0 && trigger <= 1 && grip >= 0 && grip <= 1)) return refuse("unreadable");
  const auto& q = *turned;
  const auto X_RG = checked_pose(*position, Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
  if (!X_RG) return refuse("not a rotation");
  if (position->norm() > farthest) return refuse("out of range");
  return glove::hand_on({left, *X_RG, trigger, grip});
}

}  // namespace

tl::expected<LandmarkLine, std::string_view> parse_landmarks(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return refuse(has_no_number(text) ? "not finite" : "unreadable");
  const auto field = [&](const char* name) -> const Json& {
    static const Json none;
    const auto found = json.find(name);
    return found == json.end() ? none : *found;
  };
  if (field("version") != landmark_line_version) return refuse("unknown version");
  LandmarkLine line;
  const Json &origin = field("origin"), &points = field("points_m"),
             &controller = field("controller");
  const std::string hand = small_letters(field("hand"));
  line.left = hand == "left";
  line.in_room = origin == "room";
  if ((!line.left && hand != "right") || (!line.in_room && origin != "hand") ||
      points.is_array() == controller.is_object())
    return refuse("unreadable");
  if (const Json& stamp = field("stamp_s"); !stamp.is_null()) {
    if (!stamp.is_number()) return refuse("unreadable");
    line.stamp = in_seconds(stamp.get<double>());
    // Beyond, nanoseconds since 1970 do not fit into what the messages have for them.
    if (!(std::abs(*line.stamp) < 9e9)) return refuse("out of range");
  }
  if (!take_buttons(field("buttons"), line)) return refuse("unreadable");
  const auto landmarks =
      points.is_array() ? points_in(points, line.left) : hand_on(controller, line.left);
  if (!landmarks) return tl::unexpected(landmarks.error());
  line.points = *landmarks;
  return line;
}

tl::expected<Landmarks, std::string_view> landmarks_among(const std::vector<Vector3d>& joints,
                                                          bool left) {
  if (joints.size() != 21 && joints.size() != 25 && joints.size() != max_joints)
    return refuse("wrong count");
  Landmarks made;
  for (std::size_t i = 0; i < made.size(); ++i) {
    made[i] = joints[place_of(i, joints.size())];
    if (!made[i].allFinite()) return refuse("not finite");
  }
  if (std::ranges::any_of(made, [](const Vector3d& p) { return p.norm() > farthest; })) {
    const std::string_view why = why_no_hand(made, left);
    return refuse(why.starts_with("in ") ? why : "out of range");
  }
  return made;
}

std::vector<std::string_view> documents_in(std::string_view datagram) {
  std::vector<std::string_view> found;
  while (!datagram.empty()) {
    std::size_t end = 0, depth = 0;
    bool quoted = false, ended = false;
    for (; end < datagram.size() && datagram[end] != '\n' && !ended; ++end) {
      const char c = datagram[end];
      if (quoted && c == '\\')
        ++end;
      else if (c == '"')
        quoted = !quoted;
      else if (!quoted && c == '{')
        ++depth;
      else if (!quoted && c == '}' && depth > 0)
        ended = --depth == 0;
    }
    end = std::min(end, datagram.size());
    const std::string_view text = datagram.substr(0, end);
    if (text.find_first_not_of(" \t\r") != std::string_view::npos) found.push_back(text);
    datagram.remove_prefix(end < datagram.size() && datagram[end] == '\n' ? end + 1 : end);
  }
  return found;
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
