#include "services/simulation/core/closure.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "common/grasping/blocking.hpp"

namespace prehend::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double window = 0.3;         // s
constexpr double long_window = 1.0;    // s, of fingers that tremble
constexpr double still = 0.015;        // rad, that what presses may move in the window
constexpr double still_closing = 0.1;  // rad, that the rest and the command may
constexpr double pressing = 0.03;      // rad, that the command is ahead of a joint that presses
constexpr double anew = 0.1;           // rad, of movement that makes a new closure

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

/// By this hand, with two links at least.
bool is_gripped(const std::vector<analysis::Contact>& contacts, int hand) {
  std::set<std::string_view> links;
  for (const analysis::Contact& contact : contacts)
    if (contact.hand == hand) links.insert(contact.link);
  return links.size() > 1;
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

std::optional<int> ClosureDetector::update(const grasping::World& world) {
  const model::HandModel& hand = world.hand(hand_);
  const grasping::HandMotion motion = world.hand_motion(hand_);
  const VectorXd& command = world.commanded_dof(hand_);
  if (judged_) {
    for (Index i = 0; i < motion.dof.size(); ++i) {
      const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
      if (dof.closing != 0 &&
          std::abs(motion.dof[i] - (*judged_)[i]) > anew * model::radian_of(dof)) {
        judged_.reset();
        break;
      }
    }
  }
  const std::vector<bool> presses = ahead(hand, command, motion.dof, pressing);
  const auto rested = [&](Rest& rest, double margin, double wanted) {
    if (has_moved(hand, motion.joint, rest.joint, presses, margin) || judged_ ||
        any(ahead(hand, command, rest.command, still_closing)) || !any(presses)) {
      rest = {0, motion.joint, command};
      return false;
    }
    rest.time += time_step_;
    return rest.time >= wanted;
  };
  const bool steady = rested(steady_, still, window);
  const bool trembling = rested(trembling_, still_closing, long_window);
  if (!steady && !trembling) return std::nullopt;
  for (int body = 0; body < world.body_count(); ++body)
    if (is_gripped(world.contacts(body), hand_)) {
      judged_ = motion.dof;
      return body;
    }
  return std::nullopt;
}

}  // namespace prehend::simulation
