#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include <Eigen/Core>
#include <vector>

namespace prehend::grasping {

/// Bullet's solver, for hands with gears. It goes from row to row, so that a load on one of several
/// geared joints reaches the others by a little each time, and a grip gives way. Here the gears
/// are solved first, all at once, and each other row is made to move the hand as its gears let it:
/// the projection of its impulse along the gears' own. Hands without gears are solved as by Bullet.
class GearedSolver final : public btMultiBodyConstraintSolver {
 private:
  /// Of one hand, with n velocities and k gears.
  struct Gears {
    btMultiBody* hand;
    int velocities;            // where the changes of the hand's velocities begin
    std::vector<int> rows;     // k, of the constraints that are no contacts
    Eigen::MatrixXd jacobian;  // k x n
    Eigen::MatrixXd impulse;   // k x k: of each gear, that moves one of them by one alone
    Eigen::MatrixXd answer;    // n x k: what the hand does then
    Eigen::VectorXd missing;   // k: what each gear's velocity is to change by
  };

  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count,
                                        btPersistentManifold** manifolds, int manifold_count,
                                        btTypedConstraint** constraints, int constraint_count,
                                        const btContactSolverInfo& info,
                                        btIDebugDraw* drawer) override;
  std::vector<Gears> find_gears();
  void prepare(Gears& gears);
  void solve(const Gears& gears);
  void project(const Gears& gears, btMultiBodySolverConstraint& row);
};

}  // namespace prehend::grasping
