#include "common/grasping/geared_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "common/grasping/gear.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int base_rows = 6;  // velocities of a multibody's base come before those of its joints

Eigen::Map<VectorXd> part(btAlignedObjectArray<btScalar>& values, int from, Index count) {
  return {&values[from], count};
}

bool is_gear(const btMultiBodySolverConstraint& row) {
  return dynamic_cast<const Gear*>(row.m_orgConstraint) != nullptr;
}

}  // namespace

btScalar GearedSolver::solveGroupCacheFriendlySetup(
    btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
    int manifold_count, btTypedConstraint** constraints, int constraint_count,
    const btContactSolverInfo& info, btIDebugDraw* drawer) {
  const btScalar residual = btMultiBodyConstraintSolver::solveGroupCacheFriendlySetup(
      bodies, body_count, manifolds, manifold_count, constraints, constraint_count, info, drawer);
  for (const Gears& gears : find_gears()) {
    solve(gears);
    for (auto* rows :
         {&m_multiBodyNonContactConstraints, &m_multiBodyNormalContactConstraints,
          &m_multiBodyFrictionContactConstraints, &m_multiBodyTorsionalFrictionContactConstraints,
          &m_multiBodySpinningFrictionContactConstraints})
      for (int i = 0; i < rows->size(); ++i) project(gears, (*rows)[i]);
  }
  return residual;
}

std::vector<GearedSolver::Gears> GearedSolver::find_gears() {
  std::vector<Gears> found;
  for (int i = 0; i < m_multiBodyNonContactConstraints.size(); ++i) {
    const btMultiBodySolverConstraint& row = m_multiBodyNonContactConstraints[i];
    if (!is_gear(row)) continue;
    auto of = std::find_if(found.begin(), found.end(),
                           [&](const Gears& gears) { return gears.hand == row.m_multiBodyA; });
    if (of == found.end()) {
      found.emplace_back();
      of = std::prev(found.end());
      of->hand = row.m_multiBodyA;
      of->velocities = row.m_deltaVelAindex;
    }
    of->rows.push_back(i);
  }
  for (Gears& gears : found) prepare(gears);
  return found;
}

void GearedSolver::prepare(Gears& gears) {
  const auto count = static_cast<Index>(gears.rows.size());
  const Index velocities = gears.hand->getNumDofs() + base_rows;
  gears.jacobian.resize(count, velocities);
  gears.answer.resize(velocities, count);
  gears.missing.resize(count);
  for (Index k = 0; k < count; ++k) {
    const auto& row = m_multiBodyNonContactConstraints[gears.rows[static_cast<std::size_t>(k)]];
    gears.jacobian.row(k) = part(m_data.m_jacobians, row.m_jacAindex, velocities);
    gears.answer.col(k) = part(m_data.m_deltaVelocitiesUnitImpulse, row.m_jacAindex, velocities);
    gears.missing[k] = row.m_rhs / row.m_jacDiagABInv;
  }
  gears.impulse = (gears.jacobian * gears.answer).llt().solve(MatrixXd::Identity(count, count));
  gears.answer *= gears.impulse;
}

void GearedSolver::solve(const Gears& gears) {
  auto changed = part(m_data.m_deltaVelocities, gears.velocities, gears.jacobian.cols());
  const VectorXd missing = gears.missing - gears.jacobian * changed;
  const VectorXd change = gears.answer * missing, impulse = gears.impulse * missing;
  changed += change;
  gears.hand->applyDeltaVeeMultiDof2(change.data(), 1);
  for (std::size_t k = 0; k < gears.rows.size(); ++k) {
    auto& applied = m_multiBodyNonContactConstraints[gears.rows[k]].m_appliedImpulse;
    applied += impulse[static_cast<Index>(k)];
  }
}

void GearedSolver::project(const Gears& gears, btMultiBodySolverConstraint& row) {
  if (is_gear(row) || row.m_jacDiagABInv <= 0) return;
  double lost = 0;  // of what a unit impulse changes at the row
  const auto project_side = [&](const btMultiBody* body, int at) {
    if (body != gears.hand) return;
    auto unit = part(m_data.m_deltaVelocitiesUnitImpulse, at, gears.jacobian.cols());
    const VectorXd along = gears.answer * (gears.jacobian * unit);
    lost += part(m_data.m_jacobians, at, gears.jacobian.cols()).dot(along);
    unit -= along;
  };
  project_side(row.m_multiBodyA, row.m_jacAindex);
  project_side(row.m_multiBodyB, row.m_jacBindex);
  const double left = 1 - lost * row.m_jacDiagABInv;
  const double scale = left > 1e-9 ? 1 / left : 0;
  row.m_jacDiagABInv *= scale;
  row.m_rhs *= scale;
  row.m_rhsPenetration *= scale;
  row.m_cfm *= scale;
}

}  // namespace prehend::grasping
