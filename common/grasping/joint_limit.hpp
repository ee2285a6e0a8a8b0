#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>

namespace prehend::grasping {

/// The limits of a joint, of which the solver hears only where the joint could come to one in this
/// step: rows of joints that are far from theirs cost time and change nothing.
class JointLimit final : public btMultiBodyJointLimitConstraint {
 public:
  /// rad or m.
  JointLimit(btMultiBody* body, int joint, double lower, double upper)
      : btMultiBodyJointLimitConstraint(body, joint, lower, upper), lower_(lower), upper_(upper) {}

  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override {
    const double at = m_bodyA->getJointPos(m_linkA), near = fastest * info.m_timeStep;
    if (at - lower_ < near || upper_ - at < near)
      btMultiBodyJointLimitConstraint::createConstraintRows(rows, data, info);
  }

 private:
  static constexpr double fastest = 100;  // rad/s or m/s, of a joint that is thrown about
  double lower_, upper_;
};

}  // namespace prehend::grasping
