#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::demonstration {

/// Puts features on one scale: z = A (clip((x − mean) / deviation)), where a number that is unknown
/// counts as the mean, and what lies beyond `farthest` deviations as there.
class Whitening {
 public:
  static constexpr double farthest = 4;

  /// Each feature by itself; `samples` has a column a sample, and may hold NaN.
  static Expected<Whitening> fit(const Eigen::MatrixXd& samples);
  /// The same, and then turned and stretched so that the scatter within classes is alike in all
  /// directions; `ridge` is added to it, as a share of the whole scatter. classes: of each column.
  static Expected<Whitening> fit_within(const Eigen::MatrixXd& samples,
                                        const std::vector<int>& classes, double ridge);
  /// From stored numbers. An empty `turn` is the identity.
  static Expected<Whitening> create(Eigen::VectorXd mean, Eigen::VectorXd deviation,
                                    Eigen::MatrixXd turn);

  Eigen::VectorXd apply(const Eigen::VectorXd& x) const;
  Eigen::Index inputs() const { return mean_.size(); }
  Eigen::Index outputs() const { return turn_.size() > 0 ? turn_.rows() : mean_.size(); }

  const Eigen::VectorXd& mean() const { return mean_; }
  const Eigen::VectorXd& deviation() const { return deviation_; }
  const Eigen::MatrixXd& turn() const { return turn_; }

 private:
  Whitening() = default;
  Eigen::VectorXd mean_, deviation_;
  Eigen::MatrixXd turn_;
};

}  // namespace prehend::demonstration
