#include "common/grasping/table_test.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::grasping {

bool held_on_table(const model::HandModel& hand, const Body& object, const TableGrasp& grasp,
                   const HoldOptions& hold) {
  constexpr double closing_speed = 1.0;  // rad/s, of the fingers that close as the mapping does
  constexpr double settling = 0.4;       // s
  const Pose X_WO = make_pose({0, 0, model::half_extents(object.shape).z()});
  const Pose X_WB = X_WO * grasp.X_OG * hand.X_BG().inverse();
  auto world = World::create(hand, X_WB, grasp.open);
  if (!world || !(*world)->add_body(object, X_WO)) return false;
  if ((*world)->distance_to_hand(0, 0.01) < 0) return false;
  Eigen::VectorXd squeezed = grasp.dof;
  for (Eigen::Index i = 0; i < squeezed.size(); ++i)
    squeezed[i] += grasp.closing[i] * hand.dofs()[static_cast<std::size_t>(i)].squeeze;
  const Eigen::VectorXd way = hand.clamp(squeezed) - grasp.open;
  double closing = 0;  // s
  for (Eigen::Index i = 0; i < way.size(); ++i)
    closing = std::max(
        closing, std::abs(way[i]) /
                     (closing_speed * model::radian_of(hand.dofs()[static_cast<std::size_t>(i)])));
  const double dt = (*world)->time_step();
  for (double t = 0; t < closing + settling; t += dt) {
    if (!(*world)->command(X_WB, grasp.open + std::min(1.0, t / closing) * way)) return false;
    (*world)->step();
  }
  // Shoved or toppled by its fingers, it is not grasped where it stood.
  const Pose X_WO_after = (*world)->body_motion(0).X_WO;
  if ((X_WO_after.translation() - X_WO.translation()).norm() > hold.max_slip ||
      angle_between(X_WO_after.linear(), X_WO.linear()) > hold.max_turn)
    return false;
  return hold_test(**world, 0, hold).held;
}

}  // namespace prehend::grasping
