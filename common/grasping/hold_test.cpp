#include "hold_test.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::grasping {

HoldResult hold_test(World& world, int object, const HoldOptions& options) {
  HoldResult result;
  const Pose start = world.hand_motion().X_WB;
  const Eigen::VectorXd dof = world.commanded_dof();
  const Pose X_BO = start.inverse() * world.body_motion(object).X_WO;
  const Eigen::Vector3d up = -world.gravity().normalized();

  const double dt = world.time_step();
  const double lifting = options.lift / options.lift_speed;
  const auto steps = static_cast<long>(std::ceil((lifting + options.hold) / dt));
  for (long i = 1; i <= steps; ++i) {
    const double t = static_cast<double>(i) * dt;
    Pose X_WB = start;
    X_WB.translation() += std::min(t * options.lift_speed, options.lift) * up;
    world.command(X_WB, dof);
    world.step();
    const Pose now = world.hand_motion().X_WB.inverse() * world.body_motion(object).X_WO;
    result.slip = std::max(result.slip, (now.translation() - X_BO.translation()).norm());
    result.turn = std::max(result.turn, angle_between(X_BO.linear(), now.linear()));
    if (!(result.slip < options.most_slip)) {
      result.reason = "slipped in the hand";
      return result;
    }
    if (!(result.turn < options.most_turn)) {
      result.reason = "turned in the hand";
      return result;
    }
  }
  if (world.touches_others(object)) {
    result.reason = "touches something else";
    return result;
  }
  result.held = true;
  return result;
}

}  // namespace prehend::grasping
