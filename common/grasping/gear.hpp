#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

namespace prehend::grasping {

/// Gears or bars between two joints of a hand: follower = ratio * leader + offset, whatever pushes
/// against either. One row over both joints, so that the solver knows how they move each other
/// (btMultiBodyGearConstraint of Bullet 3 takes them for parts of two bodies).
class Gear final : public btMultiBodyConstraint {
 public:
  /// ratio: rad or m of the follower per rad or m of the leader.
  Gear(btMultiBody* body, int follower, int leader, double ratio, double offset);

  void finalizeMultiDof() override;
  int getIslandIdA() const override { return island_of(m_linkA); }
  int getIslandIdB() const override { return island_of(m_linkB); }
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override;
  void debugDraw(btIDebugDraw*) override {}

 private:
  int island_of(int link) const;

  double ratio_, offset_;
};

}  // namespace prehend::grasping
