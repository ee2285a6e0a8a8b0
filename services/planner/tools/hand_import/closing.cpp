#include "services/planner/tools/hand_import/closing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/planner/tools/hand_import/contact_world.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double parallel = 0.8;  // cosine: axes that turn the same way
constexpr double fist = 2.6;      // rad, the most that a joint bends

/// A DoF flexes a finger if a joint of it turns about the axis of the last turning joint that
/// another or the same DoF drives; a single DoF always does.
bool flexes(const Skeleton& skeleton, const FingerChain& finger, int dof) {
  if (finger.dofs.size() == 1) return true;
  int last = -1;
  for (const int i : finger.joints)
    if (skeleton.joint(i).kind == model::JointKind::revolute) last = i;
  int like = 0, unlike = 0;
  for (const int i : finger.joints) {
    if (skeleton.joint(i).dof != dof) continue;
    const bool turns = skeleton.joint(i).kind == model::JointKind::revolute;
    const bool along =
        !turns || (last >= 0 && std::abs(skeleton.axis(i).dot(skeleton.axis(last))) > parallel);
    ++(along ? like : unlike);
  }
  return like > unlike;
}

/// What a DoF does to the tips that it flexes, m, from a quarter of a turn below to one above rest.
struct Effect {
  double nearer_to_palm = 0, nearer_to_others = 0;
  double nearer_to_each_other = 0;  // those that it flexes
  double travel = 0;                // of the tips
};

Effect effect_of(const Skeleton& skeleton, int dof) {
  const model::HandDof& limits = skeleton.hand().dofs()[at(dof)];
  const bool slides = limits.kind == model::JointKind::prismatic;
  const VectorXd& rest = skeleton.rest();
  const std::vector<FingerChain>& fingers = skeleton.fingers();
  VectorXd low = rest, high = rest;
  const double quarter = slides ? 1e9 : 0.5 * std::numbers::pi;  // beyond, tips come round again
  low[dof] = std::max(limits.lower, rest[dof] - quarter);
  high[dof] = std::min(limits.upper, rest[dof] + quarter);
  const auto at_low = skeleton.tips(low), at_high = skeleton.tips(high),
             at_rest = skeleton.tips(rest);
  Effect effect;
  std::vector<std::size_t> flexed;
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    if (!fingers[i].dofs.contains(dof) || !flexes(skeleton, fingers[i], dof)) continue;
    for (const std::size_t k : flexed)
      effect.nearer_to_each_other +=
          (at_low[i] - at_low[k]).norm() - (at_high[i] - at_high[k]).norm();
    flexed.push_back(i);
    Vector3d others_low = Vector3d::Zero(), others_high = others_low;
    for (std::size_t k = 0; k < fingers.size(); ++k)
      if (k != i) {
        others_low += at_low[k] / static_cast<double>(fingers.size() - 1);
        others_high += at_high[k] / static_cast<double>(fingers.size() - 1);
      }
    const Vector3d& p_BP = skeleton.p_BP();
    if (fingers.size() == 1) others_low = others_high = p_BP;
    effect.nearer_to_others += (at_low[i] - others_low).norm() - (at_high[i] - others_high).norm();
    effect.nearer_to_palm += (at_low[i] - p_BP).norm() - (at_high[i] - p_BP).norm();
    effect.travel += std::max((at_low[i] - at_rest[i]).norm(), (at_high[i] - at_rest[i]).norm());
  }
  return effect;
}

/// 1: closes towards the upper limit, -1: towards the lower, 0: does not close. Jaws close where
/// they meet: their tips may go away from the palm meanwhile.
int sense_of(const Effect& effect, bool slides, bool jaws) {
  if (!(effect.travel > 0)) return 0;
  if (std::abs(effect.nearer_to_each_other) > 0.5 * effect.travel)
    return effect.nearer_to_each_other > 0 ? 1 : -1;
  const bool meet =
      slides || (jaws && std::abs(effect.nearer_to_others) > std::abs(effect.nearer_to_palm));
  double towards_high = meet ? effect.nearer_to_others : effect.nearer_to_palm;
  // Bent equally far either way: the side of the other tips.
  if (std::abs(towards_high) < 0.02 * effect.travel) towards_high = effect.nearer_to_others;
  const bool matters = !slides || std::abs(towards_high) > 0.3 * effect.travel;
  if (!matters || towards_high == 0) return 0;
  return towards_high > 0 ? 1 : -1;
}

/// Jaws are coupled by gears; of a hand, each finger is, and the fingers by what lets them differ.
model::Coupling coupling_of(const Skeleton& skeleton, int dof) {
  const auto& joints = skeleton.hand().joints();
  if (std::ranges::count(joints, dof, &model::HandJoint::dof) < 2) return model::Coupling::springs;
  return skeleton.fingers().size() == 2 ? model::Coupling::rigid : model::Coupling::fingers;
}

Anatomy::Dof closing_of(const Skeleton& skeleton, int dof) {
  const model::HandDof& limits = skeleton.hand().dofs()[at(dof)];
  const double rest = skeleton.rest()[dof];
  const std::string& name = skeleton.joint(limits.joint).name;
  if (skeleton.is_wrist(dof)) return {name, 0, rest, rest, true};
  const bool slides = limits.kind == model::JointKind::prismatic;
  Anatomy::Dof result{name,
                      sense_of(effect_of(skeleton, dof), slides, skeleton.fingers().size() == 2),
                      rest, rest, false};
  result.coupling = coupling_of(skeleton, dof);
  if (result.closing == 0) return result;
  const double closed = result.closing > 0 ? limits.upper : limits.lower;
  const double opened = result.closing > 0 ? limits.lower : limits.upper;
  // A hand that rests closed, as grippers do, is opened.
  if (std::abs(closed - rest) < 0.5 * (limits.upper - limits.lower)) result.open = opened;
  result.fist = slides ? closed : std::clamp(closed, rest - fist, rest + fist);
  return result;
}

/// Joints of a finger that turn about the same axis close in the same sense as the last, whose
/// range tells most; that of one that bends equally far either way tells nothing.
void agree_within(const Skeleton& skeleton, const FingerChain& finger,
                  std::vector<Anatomy::Dof>& dofs) {
  const int last = finger.joints.back();
  if (skeleton.joint(last).kind != model::JointKind::revolute) return;
  const int sense = dofs[at(skeleton.joint(last).dof)].closing;
  for (const int i : finger.joints) {
    const int dof = skeleton.joint(i).dof;
    Anatomy::Dof& d = dofs[at(dof)];
    const model::HandDof& limits = skeleton.hand().dofs()[at(dof)];
    const double rest = skeleton.rest()[dof];
    const double below = rest - limits.lower, above = limits.upper - rest;
    const bool either_way = std::min(below, above) > 0.5 * std::max(below, above);
    const double along = skeleton.axis(i).dot(skeleton.axis(last));
    if (sense == 0 || d.closing == 0 || !either_way || std::abs(along) < parallel) continue;
    const int wanted = along > 0 ? sense : -sense;
    if (d.closing == wanted) continue;
    d.closing = wanted;
    d.open = rest;
    const double closed = wanted > 0 ? limits.upper : limits.lower;
    d.fist = std::clamp(closed, rest - fist, rest + fist);
  }
}

}  // namespace

std::vector<Anatomy::Dof> find_closing(const Skeleton& skeleton) {
  std::vector<Anatomy::Dof> dofs;
  for (int dof = 0; dof < skeleton.rest().size(); ++dof) dofs.push_back(closing_of(skeleton, dof));
  for (const FingerChain& finger : skeleton.fingers()) agree_within(skeleton, finger, dofs);
  return dofs;
}

VectorXd closed_by(const std::vector<Anatomy::Dof>& dofs, double share) {
  VectorXd dof(static_cast<Eigen::Index>(dofs.size()));
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const Anatomy::Dof& d = dofs[static_cast<std::size_t>(i)];
    dof[i] = d.open + share * (d.fist - d.open);
  }
  return dof;
}

}  // namespace prehend::planner
