#include "common/grasping/gear.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace prehend::grasping {
namespace {

constexpr double gear_gain = 0.2;  // share of what the two are apart that is removed each step
constexpr int base_rows = 6;  // velocities of a multibody's base come before those of its joints

}  // namespace

Gear::Gear(btMultiBody* body, int follower, int leader, double ratio, double offset)
    : btMultiBodyConstraint(body, body, follower, leader, 1, false, MULTIBODY_CONSTRAINT_GEAR),
      ratio_(ratio),
      offset_(offset) {}

void Gear::finalizeMultiDof() {
  allocateJacobiansMultiDof();
  // All of it stands on the side of body A, for it is the same body.
  jacobianA(0)[base_rows + m_bodyA->getLink(m_linkA).m_dofOffset] = 1;
  jacobianA(0)[base_rows + m_bodyA->getLink(m_linkB).m_dofOffset] = -ratio_;
  m_numDofsFinalized = m_jacSizeBoth;
}

int Gear::island_of(int link) const {
  const auto* collider = m_bodyA->getLink(link).m_collider;
  return collider ? collider->getIslandTag() : -1;
}

void Gear::createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                                const btContactSolverInfo& info) {
  if (m_numDofsFinalized != m_jacSizeBoth) finalizeMultiDof();
  btMultiBodySolverConstraint& row = rows.expandNonInitializing();
  const double apart =
      m_bodyA->getJointPos(m_linkA) - ratio_ * m_bodyA->getJointPos(m_linkB) - offset_;
  const btVector3 none(0, 0, 0);
  fillMultiBodyConstraint(row, data, jacobianA(0), jacobianB(0), none, none, none, none, 0, info,
                          -SIMD_INFINITY, SIMD_INFINITY, false, 1, false,
                          -gear_gain * apart / info.m_timeStep);
  row.m_orgConstraint = this;
  row.m_orgDofIndex = 0;
  row.m_contactNormal1 = row.m_contactNormal2 = none;
  row.m_relpos1CrossNormal = row.m_relpos2CrossNormal = none;
}

}  // namespace prehend::grasping
