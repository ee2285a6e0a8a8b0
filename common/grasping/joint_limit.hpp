#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>

namespace prehend::grasping {

/// The limits of a joint, of which the solver hears only where the joint could come to one in this
/// step: rows of all joints cost it a third of its time, and change nothing while they are far.
class JointLimit final : public btMultiBodyJointLimitConstraint {
 public:
  /// rad or m.
  JointLimit(btMultiBody* body, int joint, double lower, double upper)
      : btMultiBodyJointLimitConstraint(body, joint, lower, upper), lower_(lower), upper_(upper) {}

  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override {
    const double at = m_bodyA->getJointPos(m_linkA);
    if (at - lower_ < near || upper_ - at < near)
      btMultiBodyJointLimitConstraint::createConstraintRows(rows, data, info);
  }

 private:
  static constexpr double near = 0.2;  // rad or m: 100 per s, of steps of 2 ms
  double lower_, upper_;
};

}  // namespace prehend::grasping
