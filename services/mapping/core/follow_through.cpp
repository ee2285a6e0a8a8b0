#include "services/mapping/core/follow_through.hpp"

#include <algorithm>

namespace prehend::mapping {

FollowThrough::FollowThrough(const model::HandModel& hand, const FollowThroughOptions& options)
    : hand_(hand), options_(options), open_(hand.postures().at("open")) {
  for (const model::HandDof& dof : hand.dofs()) closing_ += dof.closing != 0;
}

void FollowThrough::reset() {
  further_ = 0;
  peak_.reset();
}

Eigen::ArrayXd FollowThrough::way(const Eigen::VectorXd& dof) const {
  Eigen::ArrayXd ways = Eigen::ArrayXd::Zero(dof.size());
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& d = hand_.dofs()[static_cast<std::size_t>(i)];
    ways[i] = std::max(0.0, d.closing * (dof[i] - open_[i]) / radian_of(d));
  }
  return ways;
}

Eigen::VectorXd FollowThrough::go_on(const Eigen::VectorXd& dof, bool closed, bool touching,
                                     Duration elapsed, double most) {
  const Eigen::ArrayXd ways = way(dof);
  const double mean = ways.sum() / closing_, longest = ways.maxCoeff();
  if (peak_ && mean < *peak_ - options_.opened) reset();
  // A hand that lifts what it holds leaves the place where the object was seen.
  if (!closed && !(peak_ && touching)) reset();
  if (closed) peak_ = std::max(peak_.value_or(mean), mean);
  if (!peak_ || longest < 1e-3) return dof;
  further_ = std::min(most, further_ + options_.speed * to_seconds(elapsed));
  Eigen::VectorXd result = dof;
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& d = hand_.dofs()[static_cast<std::size_t>(i)];
    result[i] += d.closing * radian_of(d) * further_ * ways[i] / longest;
  }
  return hand_.clamp(result);
}

}  // namespace prehend::mapping
