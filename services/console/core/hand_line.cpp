#include "services/console/core/hand_line.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace prehend::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr double farthest = 5;   // m
constexpr double max_age = 0.3;  // s; older pictures are of no use to the glove

bool is_point(const Json& point) {
  return point.is_array() && point.size() == 3 && point[0].is_number() && point[1].is_number() &&
         point[2].is_number();
}

}  // namespace

Expected<std::string> hand_line(std::string_view body, std::int64_t now_ns, const Pose& X_TW) {
  const auto wrong = [](const char* what) { return wrong_use(what, "hand"); };
  const Json said = Json::parse(body, nullptr, false);
  if (!said.is_object()) return wrong("is no JSON object");
  const auto text = [&](const char* name) { return said.value(name, Json()); };
  const Json hand = text("hand"), origin = text("origin"), age = text("age_s");
  const Json points = text("points_m");
  if (hand != "left" && hand != "right") return wrong("is neither left nor right");
  if (origin != "room" && origin != "hand") return wrong("has an origin that is none");
  if (!age.is_number() || !(age.get<double>() >= 0 && age.get<double>() <= max_age))
    return wrong("has no age from 0 to 0.3 s");
  if (!points.is_array() || (points.size() != 21 && points.size() != 25))
    return wrong("has neither 21 nor 25 points");
  std::string listed;
  for (const Json& point : points) {
    if (!is_point(point)) return wrong("has a point that is none");
    Eigen::Vector3d p(point[0].get<double>(), point[1].get<double>(), point[2].get<double>());
    if (!(p.norm() <= farthest)) return wrong("is out of reach");
    if (origin == "room") p = X_TW * p;
    listed +=
        fmt::format("{}[{:.5f},{:.5f},{:.5f}]", listed.empty() ? "" : ",", p.x(), p.y(), p.z());
  }
  const double stamp = 1e-9 * static_cast<double>(now_ns) - age.get<double>();
  return fmt::format(
      R"({{"version":1,"stamp_s":{:.6f},"hand":"{}","origin":"{}","points_m":[{}]}})", stamp,
      hand.get<std::string>(), origin.get<std::string>(), listed);
}

}  // namespace prehend::console
