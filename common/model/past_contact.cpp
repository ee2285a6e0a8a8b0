#include "common/model/past_contact.hpp"

#include <algorithm>

namespace prehend::model {

Eigen::VectorXd past_contact(const HandModel& hand, const Eigen::VectorXd& open,
                             const Eigen::VectorXd& dof, const Eigen::VectorXd& closing,
                             double angle) {
  constexpr double least = 0.1;  // rad, so that every finger presses
  Eigen::VectorXd unit(dof.size());
  for (Eigen::Index i = 0; i < unit.size(); ++i)
    unit[i] = radian_of(hand.dofs()[static_cast<std::size_t>(i)]);
  const Eigen::ArrayXd way = ((dof - open).array() * closing.array() / unit.array()).max(0.0);
  const double longest = std::max(way.maxCoeff(), 1e-9);
  const Eigen::ArrayXd further = (angle * way / longest).max(std::min(least, angle));
  return hand.clamp(dof + (further * closing.array() * unit.array()).matrix());
}

}  // namespace prehend::model
