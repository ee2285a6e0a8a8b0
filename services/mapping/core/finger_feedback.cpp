#include "services/mapping/core/finger_feedback.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::mapping {
namespace {

constexpr double at_the_end = 0.01;  // share of its way that a DoF may be short of its end

bool is_closed(const model::HandDof& dof, double value) {
  const double left = dof.closing > 0 ? dof.upper - value : value - dof.lower;
  return left <= at_the_end * (dof.upper - dof.lower);
}

/// The DoFs that close this finger, and it cannot close further.
bool stands_at_its_end(const model::HandModel& hand, int finger, const Eigen::VectorXd& value) {
  bool closes = false;
  for (const model::HandJoint& joint : hand.joints()) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(joint.dof)];
    if (hand.links()[static_cast<std::size_t>(joint.child)].finger != finger || dof.closing == 0)
      continue;
    if (!is_closed(dof, value[joint.dof])) return false;
    closes = true;
  }
  return closes;
}

}  // namespace

Expected<model::HandFeedback> feel(const model::HandModel& hand,
                                   const std::vector<LinkTouch>& touch,
                                   const Eigen::VectorXd& dof) {
  if (touch.size() != hand.links().size() ||
      dof.size() != static_cast<Eigen::Index>(hand.dofs().size()))
    return fail("touch of another hand");
  if (!dof.allFinite() || !std::all_of(touch.begin(), touch.end(), [](const LinkTouch& link) {
        return std::isfinite(link.pressure);
      }))
    return fail("touch not finite");
  model::HandFeedback feedback;
  for (std::size_t i = 0; i < touch.size(); ++i) {
    const int finger = hand.links()[i].finger;
    if (finger < 0) continue;
    const auto human = hand.fingertips()[static_cast<std::size_t>(finger)].human;
    if (!human) continue;
    model::FingerFeedback& felt = feedback[static_cast<std::size_t>(*human)];
    felt.force += std::max(0.0, touch[i].pressure);
    felt.contact |= touch[i].touching;
    felt.slip |= touch[i].slipping;
  }
  for (std::size_t finger = 0; finger < hand.fingertips().size(); ++finger)
    if (const auto human = hand.fingertips()[finger].human)
      feedback[static_cast<std::size_t>(*human)].limit |=
          stands_at_its_end(hand, static_cast<int>(finger), dof);
  return feedback;
}

}  // namespace prehend::mapping
