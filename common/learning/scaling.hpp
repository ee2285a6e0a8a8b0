#pragma once

#include <Eigen/Core>
#include <prehend/base/error.hpp>

namespace prehend::learning {

enum class ScalingKind {
  each_feature,  // every row by its own range; rows of different units then count alike
  whole_matrix   // one range for all rows, as the thesis does it
};

/// Scales numbers to [-1, 1] and back, after eq. 4.11 to 4.16 as they were meant:
/// u = 1 − 2 (v − min) / (max − min). A feature that never varied becomes 0.
class Scaling {
 public:
  /// From samples in columns. margin widens the range at both ends by that share of it, so that a
  /// sigmoid can reach the extremes. Fails on no samples and on numbers that are not finite.
  static Expected<Scaling> fit(const Eigen::MatrixXd& samples, ScalingKind kind, double margin = 0);
  /// From stored ranges; refuses what is not finite or has minimum > maximum.
  static Expected<Scaling> create(Eigen::VectorXd minimum, Eigen::VectorXd maximum);

  const Eigen::VectorXd& minimum() const { return minimum_; }
  const Eigen::VectorXd& maximum() const { return maximum_; }

  Eigen::VectorXd to_unit(const Eigen::VectorXd& v) const;
  Eigen::VectorXd from_unit(const Eigen::VectorXd& u) const;

 private:
  Scaling(Eigen::VectorXd minimum, Eigen::VectorXd maximum);
  Eigen::VectorXd minimum_, maximum_;
  Eigen::ArrayXd to_, from_;  // 2 / range or 0, range / 2
};

}  // namespace prehend::learning
