#pragma once

#include <Eigen/Core>
#include <string>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"

namespace prehend::simulation {

/// What the hand was told, with what the mapping thought of it (mode and grasp type as in the
/// message; they are only passed on).
struct Command {
  Time stamp{};
  Time origin{};
  std::string model;
  Eigen::VectorXd dof;     // rad
  Eigen::VectorXd effort;  // N m, that the DoFs may use; empty: all they have
  Pose X_WB = Pose::Identity();
  int mode = 0;
  double weight = 0;
  std::string object;
  int grasp_type = 0;
};

}  // namespace prehend::simulation
