#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/model/arm_model.hpp"

namespace prehend::planner {

/// What an arm.toml says of an arm that was made from its URDF alone.
struct ArmText {
  std::string name;
  Pose X_LE;
  std::vector<std::pair<std::string, std::string>> not_checked;
  Eigen::VectorXd home;  // empty: not yet
};

std::string write_toml(const ArmText& text);

/// Links, no neighbours, whose shapes touch in nearly every posture: they are coarse, or made so.
std::vector<std::pair<std::string, std::string>> always_touching(const model::ArmModel& arm);

/// Of many postures without a touch, with E above the base, the one from which E moves most freely
/// in all directions. The same each time.
Eigen::VectorXd nimble_posture(const model::ArmModel& arm);

}  // namespace prehend::planner
