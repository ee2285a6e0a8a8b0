#include "grasp_type.hpp"

#include <utility>

namespace prehend::mapping {

namespace {
/// Below this the hand is open, rad. Human fingers that hold something wide are hardly bent, so
/// their bending would not tell.
constexpr double least_closed = 0.6;
/// The approach counts as from above within 45 degrees.
constexpr double from_above = -0.7071;

constexpr std::array<std::pair<GraspType, std::string_view>, 4> names{{
    {GraspType::none, "none"},
    {GraspType::power_wrap, "power wrap"},
    {GraspType::circular_sphere, "circular sphere"},
    {GraspType::precision, "precision"},
}};
}  // namespace

std::string_view to_string(GraspType type) {
  for (const auto& [value, name] : names)
    if (value == type) return name;
  return "unknown";
}

std::optional<GraspType> grasp_type_from_string(std::string_view name) {
  for (const auto& [value, text] : names)
    if (text == name) return value;
  return std::nullopt;
}

GraspType grasp_type(double closed, const Pose& X_WG, bool precision) {
  if (!(closed >= least_closed)) return GraspType::none;
  if (X_WG.linear()(2, 2) > from_above) return GraspType::power_wrap;
  return precision ? GraspType::precision : GraspType::circular_sphere;
}

}  // namespace prehend::mapping
