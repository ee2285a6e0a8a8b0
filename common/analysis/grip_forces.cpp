#include "common/analysis/grip_forces.hpp"

#include <algorithm>
#include <limits>

#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/linear_program.hpp"

namespace prehend::analysis {
namespace {

using Eigen::Index;
using Eigen::Matrix4Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double slack = 1e-9;  // of the least effort, for the second program

/// The friction edges of all contacts side by side; a grip is how much of each is used.
struct Edges {
  double scale = 0;   // m, of torques, so that all rows of the programs are of one size
  MatrixXd wrenches;  // 6 x edges
  MatrixXd forces;    // 4n x edges, stacked contact forces

  Edges(const std::vector<Contact>& contacts, int edges) {
    for (const Contact& contact : contacts) scale = std::max(scale, contact.p_OC.norm());
    if (scale == 0) scale = 1;
    wrenches = contact_wrenches(contacts, scale, edges);
    forces = MatrixXd::Zero(4 * static_cast<Index>(contacts.size()), wrenches.cols());
    Index row = 0, column = 0;
    for (const Contact& contact : contacts) {
      const Matrix4Xd own = friction_edges(contact, edges);
      forces.block(row, column, 4, own.cols()) = own;
      row += 4;
      column += own.cols();
    }
  }
  Index count() const { return wrenches.cols(); }
  Matrix4Xd contact_forces(const VectorXd& use) const {
    const VectorXd stacked = forces * use.head(count());
    return Eigen::Map<const Matrix4Xd>(stacked.data(), 4, stacked.size() / 4);
  }
};

}  // namespace

Expected<std::optional<GripForces>> least_torques(const std::vector<Contact>& contacts,
                                                  const Wrench& load_O, const MatrixXd& jacobian,
                                                  const VectorXd& limits, int edges) {
  if (jacobian.rows() != 4 * static_cast<Index>(contacts.size()) ||
      jacobian.cols() != limits.size())
    return fail("the Jacobian does not fit the contacts and limits");
  if (!limits.allFinite() || (limits.array() <= 0).any())
    return fail("torque limits must be positive");
  const Edges grip(contacts, edges);
  const Index n = grip.count(), joints = limits.size();
  // Variables: the use of each edge, and the effort s. Rows: balance, and with t = torque / limit
  // t - s <= 0 <= t + s.
  LinearProgram program(n + 1, 6 + 2 * joints);
  program.cost[n] = 1;
  program.rows.topLeftCorner(6, n) = grip.wrenches;
  Wrench balance = -load_O;
  balance.tail<3>() /= grip.scale;
  // All is in proportion to the load, so the program is that of a load of one.
  const double size = balance.norm() > 0 ? balance.norm() : 1;
  balance /= size;
  program.row_lower.head(6) = program.row_upper.head(6) = balance;
  const MatrixXd efforts =
      limits.cwiseInverse().asDiagonal() * jacobian.transpose() * grip.forces;  // per edge
  program.rows.block(6, 0, joints, n) = efforts;
  program.rows.block(6, n, joints, 1).setConstant(-1);
  program.row_lower.segment(6, joints).setConstant(-unbounded);
  program.rows.block(6 + joints, 0, joints, n) = efforts;
  program.rows.block(6 + joints, n, joints, 1).setConstant(1);
  program.row_upper.segment(6 + joints, joints).setConstant(unbounded);
  auto best = minimise(program);
  if (!best) return tl::unexpected(best.error());
  if (!*best) return std::optional<GripForces>();
  program.upper[n] = (**best)[n] * (1 + slack) + slack;
  program.cost.setOnes();
  program.cost[n] = 0;
  if (const auto gentle = minimise(program); gentle && *gentle) best = gentle;

  GripForces result;
  result.forces = size * grip.contact_forces(**best);
  result.torques =
      jacobian.transpose() * Eigen::Map<const VectorXd>(result.forces.data(), jacobian.rows());
  result.effort = joints == 0 ? 0 : result.torques.cwiseQuotient(limits).cwiseAbs().maxCoeff();
  return result;
}

Expected<std::optional<Squeeze>> best_squeeze(const std::vector<Contact>& contacts, int edges) {
  const Edges grip(contacts, edges);
  const Index n = grip.count();
  // Variables: use of each edge beyond the margin, the margin.
  LinearProgram program(n + 1, 7);
  program.cost[n] = -1;
  program.rows.topLeftCorner(6, n) = grip.wrenches;
  program.rows.block(0, n, 6, 1) = grip.wrenches.rowwise().sum();
  program.rows.row(6).head(n).setOnes();
  program.rows(6, n) = static_cast<double>(n);
  program.row_lower[6] = program.row_upper[6] = 1;
  const auto best = minimise(program);
  if (!best) return tl::unexpected(best.error());
  if (!*best) return std::optional<Squeeze>();
  const double margin = (**best)[n];
  return Squeeze{grip.contact_forces((**best).head(n) + VectorXd::Constant(n, margin)), margin};
}

}  // namespace prehend::analysis
