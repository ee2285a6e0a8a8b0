#pragma once

#include <string>
#include <vector>

#include "services/recorder/core/dataset/rows.hpp"

namespace prehend::recorder::dataset {

std::vector<std::string> pose_columns(Turns turns);

/// Writes poses one after the other: of the two quaternions of an orientation the one that is
/// nearer to the one before, and at first the one with w >= 0.
class PoseWriter {
 public:
  explicit PoseWriter(Turns turns) : turns_(turns) {}

  Eigen::VectorXd numbers(const Pose& X);

 private:
  Turns turns_;
  Eigen::Vector4d last_{1, 0, 0, 0};
};

}  // namespace prehend::recorder::dataset
