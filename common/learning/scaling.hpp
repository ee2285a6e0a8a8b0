#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend::learning {

enum class ScalingKind {
  each_feature,  // every row by its own range; rows of different units then count alike
  whole_matrix,  // one range for all rows, as in [Thesis, 4.2.5]
  as_printed  // the same with the equations of [Thesis, 4.2.5] to the letter, which are wrong: see
              // Scaling
};

std::string_view to_string(ScalingKind kind);
std::optional<ScalingKind> scaling_from_string(std::string_view name);

/// Scales numbers to [-1, 1] and back, after [Thesis, eq. 4.11 to 4.16] as they were meant:
/// u = 1 − 2 (v − min) / (max − min). A feature that never varied becomes 0.
///
/// As printed they read u = (m − (v + |min|)) / m with m = max + min (4.12 to 4.14), and for the
/// way back v = m − (u − |min|) m (4.15, 4.16). That is neither within [-1, 1] nor comes back: m
/// should be max + |min|, the range is then [0, 1], and |min| must be taken off last. Kept so that
/// the study can say what it costs.
class Scaling {
 public:
  /// From samples in columns. margin widens the range at both ends by that share of it, so that a
  /// sigmoid can reach the extremes. Fails on no samples and on numbers that are not finite.
  static Expected<Scaling> fit(const Eigen::MatrixXd& samples, ScalingKind kind, double margin = 0);
  /// From stored ranges; refuses what is not finite or has minimum > maximum, and as printed also
  /// max + min = 0.
  static Expected<Scaling> create(Eigen::VectorXd minimum, Eigen::VectorXd maximum,
                                  ScalingKind kind = ScalingKind::each_feature);

  ScalingKind kind() const { return kind_; }
  const Eigen::VectorXd& minimum() const { return minimum_; }
  const Eigen::VectorXd& maximum() const { return maximum_; }

  Eigen::VectorXd to_unit(const Eigen::VectorXd& v) const;
  Eigen::VectorXd from_unit(const Eigen::VectorXd& u) const;

 private:
  Scaling(Eigen::VectorXd minimum, Eigen::VectorXd maximum, ScalingKind kind);
  Eigen::VectorXd minimum_, maximum_;
  ScalingKind kind_;
  Eigen::ArrayXd to_, from_;  // 2 / range or 0, range / 2; as printed 1 / m, m
};

}  // namespace prehend::learning
