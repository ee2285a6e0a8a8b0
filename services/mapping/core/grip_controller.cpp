#include "services/mapping/core/grip_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace prehend::mapping {

GripController::GripController(const model::HandModel& hand, const GripOptions& options)
    : hand_(hand), options_(options), contacts_(hand.dofs().size()), stops_(hand.dofs().size()),
      pushes_(hand.dofs().size()) {
  for (const model::HandDof& dof : hand.dofs())
    finger_of_.push_back(hand.links()[static_cast<std::size_t>(
        hand.joints()[static_cast<std::size_t>(dof.joint)].child)].finger);
}

namespace {
double env(const char* name, double otherwise) {
  const char* v = std::getenv(name);
  return v ? std::atof(v) : otherwise;
}
}  // namespace

void GripController::balance(const ForceSharing& sharing,
                             const std::optional<GrippedObject>& object) {
  static const double on = env("GF_ON", 0), level = env("GF_LEVEL", 0.8), press = env("GF_PRESS", 0.04),
                      gone = env("GF_GONE", 0.3), floor_ = env("GF_FLOOR", -1);
  if (on == 0 || state_.dof.size() == 0) return;
  std::vector<bool> pressing(hand_.fingertips().size(), false);
  for (std::size_t i = 0; i < pushes_.size(); ++i)
    if (finger_of_[i] >= 0 && hand_.dofs()[i].closing != 0 &&
        ((pushes_[i] && to_seconds(state_.stamp - *pushes_[i]) >= press) ||
         contacts_[i]))
      pressing[static_cast<std::size_t>(finger_of_[i])] = true;
  if (target_) {
    for (std::size_t f = 0; f < pressing.size(); ++f) pressing[f] = pressing[f] || balanced_[f];
    for (Eigen::Index i = 0; i < at_->size(); ++i)
      if (finger_of_[i] >= 0 && balanced_[finger_of_[i]] && hand_.dofs()[i].closing * (state_.dof[i] - (*at_)[i]) > gone) {
        target_.reset();
        if (std::getenv("GF_TRACE")) std::printf("gone %d\n", (int)i);
        return;
      }
    if (pressing == balanced_) return;
  }
  const auto shares = sharing.shares(state_.dof, pressing, object);
  if (std::getenv("GF_TRACE") && std::count(pressing.begin(), pressing.end(), true) > 1) {
    std::printf("pressing");
    for (const bool p : pressing) std::printf(" %d", p);
    if (shares) for (Eigen::Index i = 0; i < shares->size(); ++i) std::printf(" %.2f", (*shares)[i]);
    std::printf("\n");
  }
  if (!shares) return;
  balanced_ = pressing;
  at_ = state_.dof;
  target_ = state_.dof;
  for (Eigen::Index i = 0; i < target_->size(); ++i) {
    const auto& dof = hand_.dofs()[static_cast<std::size_t>(i)];
    const int f = finger_of_[static_cast<std::size_t>(i)];
    if (dof.closing == 0 || f < 0 || !balanced_[static_cast<std::size_t>(f)]) continue;
    (*target_)[i] += dof.closing * std::max(floor_, level * (*shares)[i]) * dof.squeeze;
    if (!contacts_[static_cast<std::size_t>(i)]) contacts_[static_cast<std::size_t>(i)] = state_.dof[i];
  }
}


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

void GripController::observe(const RobotState& state, const Eigen::VectorXd& commanded,
                             const Eigen::VectorXd& distances) {
  state_ = state;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const int closing = hand_.dofs()[i].closing;
    if (closing == 0) continue;
    const double unit = radian_of(hand_.dofs()[i]);
    const auto k = static_cast<Eigen::Index>(i);
    const double q = state.dof[k];
    // The finger got through: what it touched has gone.
    const bool balanced = target_ && finger_of_[i] >= 0 && balanced_[static_cast<std::size_t>(finger_of_[i])];
    if (!pushing(i, state, commanded) || (distances.size() > 0 && distances[k] > options_.reach)) pushes_[i].reset();
    else if (!pushes_[i]) pushes_[i] = state.stamp;
    if (!balanced && commanded.size() > 0 && closing * (commanded[k] - q) < options_.arrived * unit)
      contacts_[i].reset();
    std::optional<Stop>& stop = stops_[i];
    const bool elsewhere = distances.size() > 0 && distances[k] > options_.reach;
    if (elsewhere || !pushing(i, state, commanded)) {
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
      target_.reset();
    } else if (target_ && finger_of_[i] >= 0 && balanced_[static_cast<std::size_t>(finger_of_[i])]) {
      q = (*target_)[static_cast<Eigen::Index>(i)];
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
