#include "common/grasping/hold_test.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;

constexpr double drift_window = 0.5;  // s
constexpr double clearance = 0.4;     // m, further up before the long form if there is a table
constexpr double raising = 1.5;       // s, for that: less than 0.1 g

/// Where the base is to be, and how fast it is to go there.
struct Waypoint {
  Pose X_WB;
  Vector3d velocity = Vector3d::Zero();  // m/s
};

/// One test under way: the world, what is watched in it, and the verdict so far.
class Test {
 public:
  Test(World& world, int object, const HoldOptions& options)
      : world_(world),
        object_(object),
        options_(options),
        dof_(world.commanded_dof()),
        X_BO_start_(X_BO()),
        up_(-world.gravity().normalized()) {}

  HoldResult run() {
    const Pose start = world_.hand_motion().X_WB;
    result.lift = lift(start);
    if (!*result.lift) return result;
    Pose here = moved(start, options_.lift * up_);
    if ((options_.shake || options_.turn_over) && world_.has_table()) {
      result.held = raise(here);
      if (!result.held) return result;
      here = moved(here, clearance * up_);
    }
    if (options_.shake && !*(result.shake = shake(here))) return result;
    if (options_.turn_over && !*(result.turned_over = turn_over(here))) return result;
    result.held = true;
    return result;
  }

  HoldResult result;

 private:
  Pose X_BO() const {
    return world_.hand_motion().X_WB.inverse() * world_.body_motion(object_).X_WO;
  }

  static Pose moved(Pose X_WB, const Vector3d& by) {
    X_WB.translation() += by;
    return X_WB;
  }

  bool fail(const char* reason) {
    result.reason = reason;
    result.held = false;
    return false;
  }

  /// Follows where(t) for `time` s. False as soon as the object is lost.
  template <class Where>
  bool follow(double time, Where where) {
    const double dt = world_.time_step();
    const auto steps = static_cast<long>(std::ceil(time / dt));
    const auto window = std::min(static_cast<long>(drift_window / dt), steps);
    Vector3d before = X_BO().translation();
    for (long i = 1; i <= steps; ++i) {
      const Waypoint waypoint = where(static_cast<double>(i) * dt);
      world_.command(waypoint.X_WB, dof_, waypoint.velocity);
      world_.step();
      const Pose now = X_BO();
      result.slip = std::max(result.slip, (now.translation() - X_BO_start_.translation()).norm());
      result.turn = std::max(result.turn, angle_between(X_BO_start_.linear(), now.linear()));
      if (!(result.slip < options_.max_slip)) return fail("slipped in the hand");
      if (!(result.turn < options_.max_turn)) return fail("turned in the hand");
      if (i == steps - window) before = now.translation();
    }
    drift_ =
        (X_BO().translation() - before).norm() / (static_cast<double>(std::max(window, 1L)) * dt);
    return !world_.touches_others(object_) || fail("touches something else");
  }

  bool lift(const Pose& start) {
    const bool kept = follow(options_.lift / options_.lift_speed + options_.hold, [&](double t) {
      return Waypoint{moved(start, std::min(t * options_.lift_speed, options_.lift) * up_)};
    });
    result.drift = drift_;
    return kept;
  }

  bool raise(const Pose& start) {
    return follow(raising, [&](double t) {
      const double share = 0.5 * (1 - std::cos(std::numbers::pi * t / raising));
      return Waypoint{moved(start, share * clearance * up_)};
    });
  }

  /// There and back in each direction, always at the full acceleration one way or the other.
  bool shake(const Pose& rest) {
    const double a = options_.shake_acceleration;
    const double quarter = std::sqrt(options_.shake_stroke / a);  // s; half the way there
    for (int direction = 0; direction < 6; ++direction) {
      const Vector3d axis =
          (direction % 2 == 0 ? 1.0 : -1.0) * rest.linear().col(direction / 2).normalized();
      const bool kept = follow(4 * quarter, [&](double t) {
        const double u = t < 2 * quarter ? t : 4 * quarter - t;  // the way back mirrors the way out
        const double left = 2 * quarter - u;
        const double distance =
            u < quarter ? 0.5 * a * u * u : options_.shake_stroke - 0.5 * a * left * left;
        const double speed = a * std::min(u, left) * (t < 2 * quarter ? 1 : -1);
        return Waypoint{moved(rest, distance * axis), speed * axis};
      });
      if (!kept) return false;
    }
    return true;
  }

  bool turn_over(const Pose& rest) {
    // About a horizontal axis through the base: x of B, or y where x points up or down.
    Vector3d axis = rest.linear().col(0) - rest.linear().col(0).dot(up_) * up_;
    if (axis.norm() < 0.5) axis = rest.linear().col(1) - rest.linear().col(1).dot(up_) * up_;
    axis.normalize();
    const double turning = std::numbers::pi / options_.turn_rate;
    const bool kept = follow(turning + options_.turned_hold, [&](double t) {
      Pose X_WB = rest;
      X_WB.linear() =
          Eigen::AngleAxisd(std::min(t, turning) * options_.turn_rate, axis) * rest.linear();
      return Waypoint{X_WB};
    });
    result.drift = drift_;
    return kept;
  }

  World& world_;
  const int object_;
  const HoldOptions& options_;
  const Eigen::VectorXd dof_;
  const Pose X_BO_start_;
  const Vector3d up_;
  double drift_ = 0;  // m/s, at the end of the last movement
};

}  // namespace

HoldResult hold_test(World& world, int object, const HoldOptions& options) {
  return Test(world, object, options).run();
}

}  // namespace prehend::grasping
