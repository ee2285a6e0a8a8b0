#include "services/mapping/core/force_sharing.hpp"

#include <limits>

#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/grasp_map.hpp"
#include "common/analysis/linear_program.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int edges = 8;
constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double min_margin = 1e-3;  // N: below, a contact is about to slip as soon as it presses

}  // namespace

ForceSharing::ForceSharing(const model::HandModel& hand, const ForceSharingOptions& options)
    : hand_(hand),
      distances_(hand),
      options_(options),
      coupling_(analysis::coupling(hand)),
      effort_(VectorXd::Zero(static_cast<Index>(hand.dofs().size()))) {
  for (const model::HandJoint& joint : hand.joints())
    effort_[joint.dof] += std::abs(joint.multiplier) * joint.max_torque;
}

/// Where the pressing fingers touch; of an object that is not known, with their tips and in the
/// direction in which they close.
std::vector<FingerTouch> ForceSharing::touches(const VectorXd& dof,
                                               const std::vector<bool>& pressing,
                                               const std::optional<GrippedObject>& object) const {
  std::vector<FingerTouch> found;
  if (object) {
    for (FingerTouch& touch : distances_.touches(dof, object->shape, object->X_BO, options_.within))
      if (pressing[static_cast<std::size_t>(touch.finger)]) found.push_back(touch);
    return found;
  }
  VectorXd further = dof;
  for (std::size_t i = 0; i < hand_.dofs().size(); ++i)
    further[static_cast<Index>(i)] += 1e-3 * hand_.dofs()[i].closing * radian_of(hand_.dofs()[i]);
  const auto before = hand_.fingertip_positions(dof), after = hand_.fingertip_positions(further);
  for (std::size_t f = 0; f < before.size(); ++f) {
    const Vector3d way = after[f] - before[f];
    if (pressing[f] && way.norm() > 0)
      found.push_back({static_cast<int>(f), hand_.fingertips()[f].link, 0, before[f],
                       way.normalized()});
  }
  return found;
}

std::optional<VectorXd> ForceSharing::shares(const VectorXd& dof, const std::vector<bool>& pressing,
                                             const std::optional<GrippedObject>& object) const {
  std::vector<analysis::Contact> contacts;
  Vector3d middle = Vector3d::Zero();
  const auto touched = touches(dof, pressing, object);
  if (touched.size() < 2) return std::nullopt;
  for (const FingerTouch& touch : touched)
    middle += touch.p_B / static_cast<double>(touched.size());
  double radius = 1e-3;  // m
  for (const FingerTouch& touch : touched) {
    analysis::Contact contact;
    contact.link = hand_.links()[static_cast<std::size_t>(touch.link)].name;
    contact.p_OC = touch.p_B - middle;
    contact.normal_O = touch.normal_B;
    contact.friction = options_.friction;
    radius = std::max(radius, contact.p_OC.norm());
    contacts.push_back(contact);
  }
  const auto jacobian = analysis::contact_jacobian(
      hand_, hand_.joint_angles(dof), Pose(Eigen::Translation3d(middle)), contacts);
  if (!jacobian) return std::nullopt;

  // Variables: use of each friction edge beyond the margin, the margin. Rows: balance, and the
  // efforts in shares of what the DoFs have.
  const MatrixXd wrenches = analysis::contact_wrenches(contacts, radius, edges);
  const Index n = wrenches.cols();
  MatrixXd forces = MatrixXd::Zero(jacobian->rows(), n);
  Index column = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Matrix4Xd own = analysis::friction_edges(contacts[i], edges);
    forces.block(4 * static_cast<Index>(i), column, 4, own.cols()) = own;
    column += own.cols();
  }
  const MatrixXd efforts =
      effort_.cwiseInverse().asDiagonal() * coupling_.transpose() * jacobian->transpose() * forces;
  std::vector<Index> driven;
  for (Index i = 0; i < effort_.size(); ++i)
    if (hand_.dofs()[static_cast<std::size_t>(i)].closing != 0) driven.push_back(i);
  analysis::LinearProgram program(n + 1, 6 + static_cast<Index>(driven.size()));
  program.cost[n] = -1;
  program.rows.topLeftCorner(6, n) = wrenches;
  for (std::size_t k = 0; k < driven.size(); ++k) {
    const auto row = 6 + static_cast<Index>(k);
    program.rows.row(row).head(n) = efforts.row(driven[k]);
    program.row_lower[row] = -1;
    program.row_upper[row] = 1;
  }
  program.rows.col(n) = program.rows.leftCols(n).rowwise().sum();
  program.upper[n] = 1e3;
  const auto best = analysis::minimise(program);
  if (!best || !*best || (**best)[n] < min_margin) return std::nullopt;
  const VectorXd use = (**best).head(n).array() + (**best)[n];
  VectorXd shares = VectorXd::Zero(effort_.size());
  for (const Index i : driven)
    shares[i] = hand_.dofs()[static_cast<std::size_t>(i)].closing * efforts.row(i).dot(use);
  return shares;
}

}  // namespace prehend::mapping
