#include "services/mapping/core/grasp_type.hpp"

#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::mapping {

namespace {
/// Below this the hand is open, rad. Human fingers that hold something wide are hardly bent, so
/// their bending would not tell.
constexpr double min_closed = 0.6;
/// The approach counts as from above within 45 degrees.
constexpr double from_above = -0.7071;

constexpr auto grasp_type_names =
    named_values<GraspType>({{GraspType::none, "none"},
                             {GraspType::power_wrap, "power wrap"},
                             {GraspType::circular_sphere, "circular sphere"},
                             {GraspType::precision, "precision"}});
}  // namespace

std::string_view to_string(GraspType type) {
  return grasp_type_names.name(type);
}

std::optional<GraspType> grasp_type_from_string(std::string_view name) {
  return grasp_type_names.value(name);
}

GraspType grasp_type(double closed, const Pose& X_WG, bool precision) {
  if (!(closed >= min_closed)) return GraspType::none;
  if (X_WG.linear()(2, 2) > from_above) return GraspType::power_wrap;
  return precision ? GraspType::precision : GraspType::circular_sphere;
}

double mean_closing(const model::HandModel& hand, const Eigen::VectorXd& dof) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
    const model::HandDof& d = hand.dofs()[i];
    if (d.closing == 0) continue;
    sum += d.closing * (dof[static_cast<Eigen::Index>(i)] - (d.closing > 0 ? d.lower : d.upper));
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

}  // namespace prehend::mapping
