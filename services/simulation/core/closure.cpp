#include "services/simulation/core/closure.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "common/grasping/blocking.hpp"

namespace prehend::simulation {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double window = 0.3;          // s
constexpr double long_window = 1.0;     // s, of fingers that tremble
constexpr double still = 0.015;         // rad, that what presses may move in the window
constexpr double still_closing = 0.1;   // rad, that the rest and the command may
constexpr double pressing = 0.03;       // rad, that the command is ahead of a joint that presses
constexpr double anew = 0.1;            // rad, of movement that makes a new closure
constexpr double pushing = 0.005;       // m, that a base which pushes stays behind
constexpr double still_pushing = 0.01;  // m, by which that may change

/// Which DoFs are ahead in the closing direction by more than `margin` rad.
std::vector<bool> ahead(const model::HandModel& hand, const VectorXd& command,
                        const VectorXd& value, double margin) {
  std::vector<bool> is_ahead(hand.dofs().size());
  for (std::size_t i = 0; i < is_ahead.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[i];
    const auto k = static_cast<Index>(i);
    is_ahead[i] = dof.closing * (command[k] - value[k]) > margin * model::radian_of(dof);
  }
  return is_ahead;
}

bool any(const std::vector<bool>& values) {
  return std::find(values.begin(), values.end(), true) != values.end();
}

/// A joint has moved by more than it may: what presses by more than `margin`, rad. A finger that
/// presses on nothing follows the operator's, and that trembles with the noise of the glove.
bool has_moved(const model::HandModel& hand, const VectorXd& joint, const VectorXd& before,
               const std::vector<bool>& presses, double margin) {
  if (before.size() != joint.size()) return true;
  for (Index i = 0; i < joint.size(); ++i) {
    const auto dof = static_cast<std::size_t>(hand.joints()[static_cast<std::size_t>(i)].dof);
    const double may = presses[dof] ? margin : still_closing;
    if (std::abs(joint[i] - before[i]) > may * model::radian_of(hand.dofs()[dof])) return true;
  }
  return false;
}

/// By this hand, with two links at least; or, when it pushes, between it and another.
bool is_gripped(const std::vector<analysis::Contact>& contacts, int hand, bool pushes) {
  std::set<std::string_view> links;
  bool other = false;
  for (const analysis::Contact& contact : contacts)
    if (contact.hand == hand)
      links.insert(contact.link);
    else
      other = true;
  return links.size() > 1 || (pushes && other && !links.empty());
}

/// How far the base is behind where it is told to be, m, in W. One of several gives way.
Vector3d behind_of(const grasping::World& world, int hand) {
  if (world.hand_count() < 2) return Vector3d::Zero();
  return world.commanded_base(hand).translation() - world.base(hand).translation();
}

}  // namespace

GraspVerdict judge(Closure& closure) {
  GraspVerdict verdict;
  // Contacts come from the simulation and are finite; should the hull fail all the same, the grasp
  // has no force closure that anyone could show.
  if (auto quality =
          analysis::grasp_quality(grasping::about_centre_of_mass(closure.contacts, closure.object),
                                  grasping::torque_scale(closure.object)))
    verdict.quality = std::move(*quality);
  for (const analysis::Contact& contact : closure.contacts)
    verdict.penetration = std::max(verdict.penetration, contact.depth);
  const model::HandModel& hand = closure.world->hand(closure.hand);
  const auto joint = closure.world->hand_motion(closure.hand).joint;
  if (const auto blocking = grasping::find_blocking(hand, joint))
    verdict.blocking = grasping::to_string(*blocking, hand);
  verdict.hold = grasping::hold_test(*closure.world, closure.body);
  return verdict;
}

void ClosureDetector::forget(const grasping::World& world, const grasping::HandMotion& motion) {
  const auto& dofs = world.hand(hand_).dofs();
  for (std::size_t i = 0; judged_ && i < dofs.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const double moved = std::abs(motion.dof[k] - (*judged_)[k]);
    if (dofs[i].closing != 0 && moved > anew * model::radian_of(dofs[i])) judged_.reset();
  }
  if (judged_ && pushed_ && !world.hand_touches_anything(hand_)) judged_.reset();
}

std::optional<int> ClosureDetector::update(const grasping::World& world) {
  const model::HandModel& hand = world.hand(hand_);
  const grasping::HandMotion motion = world.hand_motion(hand_);
  const VectorXd& command = world.commanded_dof(hand_);
  forget(world, motion);
  const std::vector<bool> presses = ahead(hand, command, motion.dof, pressing);
  const Vector3d behind = behind_of(world, hand_);
  const bool grips = any(presses), pushes = behind.norm() > pushing;
  const auto rested = [&](Rest& rest, double margin, double wanted) {
    const bool pushes_on = pushes && (behind - rest.behind).norm() < still_pushing;
    if (has_moved(hand, motion.joint, rest.joint, presses, margin) || judged_ ||
        any(ahead(hand, command, rest.command, still_closing)) || !(grips || pushes_on)) {
      rest = {0, motion.joint, command, behind};
      return false;
    }
    rest.time += time_step_;
    return rest.time >= wanted;
  };
  const bool steady = rested(steady_, still, window);
  const bool trembling = rested(trembling_, still_closing, long_window);
  if (!steady && !trembling) return std::nullopt;
  for (int body = 0; body < world.body_count(); ++body)
    if (is_gripped(world.contacts(body), hand_, pushes)) {
      judged_ = motion.dof;
      pushed_ = pushes;
      return body;
    }
  return std::nullopt;
}

}  // namespace prehend::simulation
