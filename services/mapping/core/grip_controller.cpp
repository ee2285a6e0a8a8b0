#include "services/mapping/core/grip_controller.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::mapping {

GripController::GripController(const model::HandModel& hand, const GripOptions& options)
    : hand_(hand), options_(options), contacts_(hand.dofs().size()), stops_(hand.dofs().size()) {}

/// True while the finger is told to close further than it gets.
bool GripController::pushing(std::size_t dof, const RobotState& state,
                             const Eigen::VectorXd& commanded) const {
  const int closing = hand_.dofs()[dof].closing;
  const double unit = radian_of(hand_.dofs()[dof]);
  const auto i = static_cast<Eigen::Index>(dof);
  if (commanded.size() > 0 && closing * (commanded[i] - state.dof[i]) > options_.lag * unit)
    return true;
  for (std::size_t j = 0; j < hand_.joints().size(); ++j) {
    const model::HandJoint& joint = hand_.joints()[j];
    if (joint.dof != static_cast<int>(dof) || joint.multiplier == 0) continue;
    const double torque =
        std::copysign(1.0, closing * joint.multiplier) * state.torque[static_cast<Eigen::Index>(j)];
    if (torque > options_.torque_share * joint.max_torque) return true;
  }
  return false;
}

void GripController::observe(const RobotState& state, const Eigen::VectorXd& commanded) {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const int closing = hand_.dofs()[i].closing;
    if (closing == 0) continue;
    const double unit = radian_of(hand_.dofs()[i]);
    const auto k = static_cast<Eigen::Index>(i);
    const double q = state.dof[k];
    // The finger got through: what it touched has gone.
    if (commanded.size() > 0 && closing * (commanded[k] - q) < options_.arrived * unit)
      contacts_[i].reset();
    std::optional<Stop>& stop = stops_[i];
    if (!pushing(i, state, commanded)) {
      stop.reset();
      continue;
    }
    if (!stop || std::abs(q - stop->dof) > options_.still * unit) stop = Stop{state.stamp, q};
    if (state.stamp - stop->since < options_.settle) continue;
    if (!contacts_[i]) contacts_[i] = q;
  }
  if (!touching())
    held_.reset();
  else if (!held_)
    held_ = commanded.size() > 0 ? commanded : state.dof;
}

Eigen::VectorXd GripController::squeeze(const Eigen::VectorXd& mapped) {
  Eigen::VectorXd result = mapped;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const int closing = hand_.dofs()[i].closing;
    if (closing == 0 && held_)
      result[static_cast<Eigen::Index>(i)] = (*held_)[static_cast<Eigen::Index>(i)];
    if (!contacts_[i]) continue;
    const double unit = radian_of(hand_.dofs()[i]);
    double& q = result[static_cast<Eigen::Index>(i)];
    if (closing * (q - *contacts_[i]) < -options_.open * unit) {
      contacts_[i].reset();
      stops_[i].reset();
    } else {
      q = *contacts_[i] + closing * options_.squeeze * unit;
    }
  }
  return hand_.clamp(result);
}

bool GripController::touching() const {
  return std::any_of(contacts_.begin(), contacts_.end(),
                     [](const auto& contact) { return contact.has_value(); });
}

}  // namespace prehend::mapping
