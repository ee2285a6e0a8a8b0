#include "common/grasping/hold_test.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

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

/// A hand as the test found it.
struct Holding {
  Eigen::VectorXd dof;  // commanded
  Pose X_BO;
  Pose X_WB;  // commanded before and after each movement
};

/// One test under way: the world, what is watched in it, and the verdict so far.
class Test {
 public:
  Test(World& world, int object, const HoldOptions& options)
      : world_(world), object_(object), options_(options), up_(-world.gravity().normalized()) {
    for (int hand = 0; hand < world.hand_count(); ++hand) {
      const Eigen::VectorXd dof = world.commanded_dof(hand);
      world.hold_still(hand);
      hands_.push_back({dof, X_BO(hand), world.commanded_base(hand)});
    }
  }

  HoldResult run() {
    result.lift = lift();
    if (!*result.lift) return result;
    if ((options_.shake || options_.turn_over) && world_.has_table()) {
      result.held = raise();
      if (!result.held) return result;
    }
    if (options_.shake && !*(result.shake = shake())) return result;
    if (options_.turn_over && !*(result.turned_over = turn_over())) return result;
    result.held = true;
    return result;
  }

  HoldResult result;

 private:
  Pose X_BO(int hand) const {
    return world_.base(hand).inverse() * world_.body_motion(object_).X_WO;
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

  /// All hands follow where(t, X_WB), the second of which is where they rest, for `time` s. False
  /// as soon as the object is lost.
  template <class Where>
  bool follow(double time, Where where) {
    const double dt = world_.time_step();
    const auto steps = static_cast<long>(std::ceil(time / dt));
    const auto window = std::min(static_cast<long>(drift_window / dt), steps);
    Vector3d before = X_BO(0).translation();
    for (long i = 1; i <= steps; ++i) {
      lead(static_cast<double>(i) * dt, where);
      world_.step();
      look();
      if (!(result.slip < options_.max_slip)) return fail("slipped in the hand");
      if (!(result.turn < options_.max_turn)) return fail("turned in the hand");
      if (i == steps - window) before = X_BO(0).translation();
    }
    drift_ =
        (X_BO(0).translation() - before).norm() / (static_cast<double>(std::max(window, 1L)) * dt);
    return !world_.touches_others(object_) || fail("touches something else");
  }

  template <class Where>
  void lead(double t, Where where) {
    for (int hand = 0; hand < world_.hand_count(); ++hand) {
      const Holding& holding = hands_[static_cast<std::size_t>(hand)];
      const Waypoint waypoint = where(t, holding.X_WB);
      world_.command(waypoint.X_WB, holding.dof, waypoint.velocity, hand);
    }
  }

  void look() {
    for (int hand = 0; hand < world_.hand_count(); ++hand) {
      const Pose start = hands_[static_cast<std::size_t>(hand)].X_BO, now = X_BO(hand);
      result.slip = std::max(result.slip, (now.translation() - start.translation()).norm());
      result.turn = std::max(result.turn, angle_between(start.linear(), now.linear()));
    }
  }

  void rest_higher(double height) {
    for (Holding& hand : hands_) hand.X_WB = moved(hand.X_WB, height * up_);
  }

  bool lift() {
    const bool kept = follow(
        options_.lift / options_.lift_speed + options_.hold, [&](double t, const Pose& X_WB) {
          return Waypoint{moved(X_WB, std::min(t * options_.lift_speed, options_.lift) * up_)};
        });
    result.drift = drift_;
    rest_higher(options_.lift);
    return kept;
  }

  bool raise() {
    const bool kept = follow(raising, [&](double t, const Pose& X_WB) {
      const double share = 0.5 * (1 - std::cos(std::numbers::pi * t / raising));
      return Waypoint{moved(X_WB, share * clearance * up_)};
    });
    rest_higher(clearance);
    return kept;
  }

  /// There and back in each direction, always at the full acceleration one way or the other.
  bool shake() {
    const Eigen::Matrix3d axes = hands_.front().X_WB.linear();
    const double a = options_.shake_acceleration;
    const double quarter = std::sqrt(options_.shake_stroke / a);  // s; half the way there
    for (int direction = 0; direction < 6; ++direction) {
      const Vector3d axis =
          (direction % 2 == 0 ? 1.0 : -1.0) * axes.col(direction / 2).normalized();
      const bool kept = follow(4 * quarter, [&](double t, const Pose& X_WB) {
        const double u = t < 2 * quarter ? t : 4 * quarter - t;  // the way back mirrors the way out
        const double left = 2 * quarter - u;
        const double distance =
            u < quarter ? 0.5 * a * u * u : options_.shake_stroke - 0.5 * a * left * left;
        const double speed = a * std::min(u, left) * (t < 2 * quarter ? 1 : -1);
        return Waypoint{moved(X_WB, distance * axis), speed * axis};
      });
      if (!kept) return false;
    }
    return true;
  }

  bool turn_over() {
    // About a horizontal axis through the first base: x of B, or y where x points up or down.
    const Pose rest = hands_.front().X_WB;
    Vector3d axis = rest.linear().col(0) - rest.linear().col(0).dot(up_) * up_;
    if (axis.norm() < 0.5) axis = rest.linear().col(1) - rest.linear().col(1).dot(up_) * up_;
    axis.normalize();
    const double turning = std::numbers::pi / options_.turn_rate;
    const bool kept = follow(turning + options_.turned_hold, [&](double t, Pose X_WB) {
      const Eigen::AngleAxisd turned(std::min(t, turning) * options_.turn_rate, axis);
      X_WB.linear() = turned * X_WB.linear();
      X_WB.translation() = rest.translation() + turned * (X_WB.translation() - rest.translation());
      return Waypoint{X_WB};
    });
    result.drift = drift_;
    return kept;
  }

  World& world_;
  const int object_;
  const HoldOptions& options_;
  const Vector3d up_;
  std::vector<Holding> hands_;
  double drift_ = 0;  // m/s, at the end of the last movement
};

}  // namespace

HoldResult hold_test(World& world, int object, const HoldOptions& options) {
  return Test(world, object, options).run();
}

}  // namespace prehend::grasping
