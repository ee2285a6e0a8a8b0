#pragma once

#include <array>
#include <optional>
#include <prehend/base/pose.hpp>
#include <string_view>

namespace prehend::mapping {

enum class GraspType { none, power_wrap, circular_sphere, precision };

/// All but none.
inline constexpr std::array grasp_types{GraspType::power_wrap, GraspType::circular_sphere,
                                        GraspType::precision};

/// As in training sets and on the screen: «power wrap».
std::string_view to_string(GraspType type);
std::optional<GraspType> grasp_type_from_string(std::string_view name);

/// Which grasp a hand is making, by where its palm comes from and what its fingers do:
///   robot fingers (to be) open           -> none
///   palm from the side                   -> power wrap
///   from above                           -> precision or circular sphere
/// closed: mean angle of the robot's closing DoFs as mapped, rad. X_WG: the hand's grasp frame on
/// the table. precision: what MappingModel::is_precision says of the fingers.
GraspType grasp_type(double closed, const Pose& X_WG, bool precision);

}  // namespace prehend::mapping
