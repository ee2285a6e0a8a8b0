#include "closure.hpp"

#include <algorithm>
#include <cmath>
#include <prehend/grasping/blocking.hpp>

namespace prehend::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double window = 0.3;         // s
constexpr double still_speed = 0.05;   // rad/s
constexpr double still_closing = 0.1;  // rad, that the command may still close in the window
constexpr double pressing = 0.03;      // rad, that the command is ahead of a joint that presses
constexpr double anew = 0.1;           // rad, of movement that makes a new closure

/// DoFs whose command is ahead in the closing direction by more than `margin` rad.
int count_ahead(const model::HandModel& hand, const VectorXd& command, const VectorXd& value,
                double margin) {
  int count = 0;
  for (Index i = 0; i < value.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    count += dof.closing * (command[i] - value[i]) > margin * grasping::radian_of(dof);
  }
  return count;
}

/// A joint has moved by more than `margin` rad.
bool has_moved(const model::HandModel& hand, const VectorXd& joint, const VectorXd& before,
               double margin) {
  if (before.size() != joint.size()) return true;
  for (Index i = 0; i < joint.size(); ++i) {
    const int dof = hand.joints()[static_cast<std::size_t>(i)].dof;
    const double unit = grasping::radian_of(hand.dofs()[static_cast<std::size_t>(dof)]);
    if (std::abs(joint[i] - before[i]) > margin * unit) return true;
  }
  return false;
}

bool is_gripped(const std::vector<analysis::Contact>& contacts) {
  return std::any_of(contacts.begin(), contacts.end(),
                     [&](const auto& contact) { return contact.link != contacts.front().link; });
}

}  // namespace

Verdict judge(Closure& closure) {
  Verdict verdict;
  // Contacts come from the simulation and are finite; should the hull fail all the same, the grasp
  // has no force closure that anyone could show.
  if (auto quality =
          analysis::grasp_quality(closure.contacts, grasping::torque_scale(closure.object)))
    verdict.quality = std::move(*quality);
  for (const analysis::Contact& contact : closure.contacts)
    verdict.penetration = std::max(verdict.penetration, contact.depth);
  const model::HandModel& hand = closure.world->hand();
  if (const auto blocking = grasping::find_blocking(hand, closure.world->hand_motion().joint))
    verdict.blocking = grasping::to_string(*blocking, hand);
  verdict.hold = grasping::hold_test(*closure.world, closure.body);
  return verdict;
}

void ClosureDetector::restart(const VectorXd& joint, const VectorXd& command) {
  still_ = 0;
  joint_ = joint;
  command_ = command;
}

std::optional<int> ClosureDetector::update(const grasping::World& world) {
  const grasping::HandMotion motion = world.hand_motion();
  const VectorXd& command = world.commanded_dof();
  if (judged_) {
    for (Index i = 0; i < motion.dof.size(); ++i) {
      const model::HandDof& dof = world.hand().dofs()[static_cast<std::size_t>(i)];
      if (dof.closing != 0 &&
          std::abs(motion.dof[i] - (*judged_)[i]) > anew * grasping::radian_of(dof)) {
        judged_.reset();
        break;
      }
    }
  }
  const bool moved = has_moved(world.hand(), motion.joint, joint_, still_speed * window) ||
                     count_ahead(world.hand(), command, command_, still_closing) > 0;
  if (moved || judged_ || count_ahead(world.hand(), command, motion.dof, pressing) < 2) {
    restart(motion.joint, command);
    return std::nullopt;
  }
  still_ += time_step_;
  if (still_ < window) return std::nullopt;
  for (int body = 0; body < world.body_count(); ++body)
    if (is_gripped(world.contacts(body))) {
      judged_ = motion.dof;
      return body;
    }
  return std::nullopt;
}

}  // namespace prehend::simulation
