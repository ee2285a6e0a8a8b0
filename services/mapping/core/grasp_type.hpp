#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"

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
/// closed: mean_closing() of the robot's fingers as mapped, rad. X_WG: the hand's grasp frame on
/// the table. precision: what MappingModel::is_precision says of the fingers.
GraspType grasp_type(double closed, const Pose& X_WG, bool precision);

/// Mean angle of a robot posture's closing DoFs from their open end, rad.
double mean_closing(const model::HandModel& hand, const Eigen::VectorXd& dof);

}  // namespace prehend::mapping
