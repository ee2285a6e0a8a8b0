#include "common/arm/controller.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::arm {
namespace {

using Eigen::Vector3d;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, model::max_arm_joints,
                             model::max_arm_joints>;

constexpr double max_dt = 0.1;                    // s
constexpr double usual_dt = 0.01;                 // s, of steps after this one
constexpr double trust_m = 0.1, trust_rad = 0.3;  // of the linear step
constexpr double there_m = 1e-3, there_rad = 5e-3;
constexpr double calm = 0.8;           // of the acceleration, that slows down before the wish
constexpr double at_rest = 0.01;       // of a joint's velocity limit
constexpr double home_rate = 0.5;      // 1/s, of a redundant joint to its home
constexpr double probe = 0.05;         // rad, out of a singularity
constexpr double approach_rate = 4.0;  // 1/s: speed towards something by how far it is
constexpr double spare = 0.005;        // m, that slowing leaves to the clearance
constexpr double sight = 0.4;          // m, how far distances are looked at
constexpr int max_looks = 16;          // at postures on the way to rest
constexpr std::size_t max_rows = 8;
constexpr int sweeps = 40;

constexpr auto hindrance_names = named_values<Hindrance>({{Hindrance::none, "none"},
                                                          {Hindrance::on_the_way, "on the way"},
                                                          {Hindrance::joint_limit, "joint limit"},
                                                          {Hindrance::collision, "collision"},
                                                          {Hindrance::reach, "out of reach"},
                                                          {Hindrance::no_wish, "no wish"}});

/// The greatest velocity from which a joint can come to rest within `room`, after a step of dt.
double brakeable(double room, double acceleration, double dt) {
  return acceleration * (std::sqrt(dt * dt + 2 * std::max(room, 0.0) / acceleration) - dt);
}

double joint_acceleration(const model::ArmModel& arm, Eigen::Index i) {
  return arm.joints[static_cast<std::size_t>(i)].acceleration;
}

/// How far a joint turns in t s that begin with dt at this velocity and go on braking, as the usual
/// steps do: each at one velocity. Joints that brake smoothly would take another way together.
double turned(double velocity, double acceleration, double dt, double t) {
  const double speed = std::abs(velocity), h = std::min(dt, usual_dt), slower = acceleration * h;
  const double steps = std::min(std::max(t - dt, 0.0) / h, std::floor(speed / slower));
  const double whole = std::floor(steps);
  const double braking = whole * speed - slower * whole * (whole + 1) / 2 +
                         (steps - whole) * std::max(speed - (whole + 1) * slower, 0.0);
  return std::copysign(std::min(t, dt) * speed + h * braking, velocity);
}

/// Velocity of a point of a link over velocities of the joints, along a direction.
Joints slope(const model::ArmModel& arm, const Configuration& at, int link, const Vector3d& p_A,
             const Vector3d& direction) {
  Joints row = Joints::Zero(static_cast<Eigen::Index>(arm.joints.size()));
  for (int i = 0; i < link; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Pose& X = at.X_AL[k + 1];
    row[i] = direction.dot((X.linear() * arm.joints[k].axis_J).cross(p_A - X.translation()));
  }
  return row;
}

/// c · v >= b
struct Row {
  Joints c;
  double b = 0;
};

/// The v nearest to `wanted` by the metric H that keeps to the rows, by Hildreth's method. True: a
/// row counts that is not of the first `boxes`.
bool solve(const Square& H, const std::vector<Row>& rows, std::size_t boxes, Joints& wanted) {
  const auto n = wanted.size(), m = static_cast<Eigen::Index>(rows.size());
  constexpr int most = 2 * model::max_arm_joints + static_cast<int>(max_rows);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, model::max_arm_joints> C(m, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1> gap(m), force(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    C.row(i) = rows[static_cast<std::size_t>(i)].c.transpose();
    gap[i] = rows[static_cast<std::size_t>(i)].b - C.row(i).dot(wanted);
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, model::max_arm_joints, most> P =
      H.ldlt().solve(C.transpose());
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most> A = C * P;
  force.setZero();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double change = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      if (A(i, i) < 1e-12) continue;
      const double next = std::max(0.0, force[i] + (gap[i] - A.row(i).dot(force)) / A(i, i));
      change = std::max(change, std::abs(next - force[i]) * std::sqrt(A(i, i)));
      force[i] = next;
    }
    if (change < 1e-6) break;
  }
  wanted += P * force;
  return m > static_cast<Eigen::Index>(boxes) &&
         force.tail(m - static_cast<Eigen::Index>(boxes)).maxCoeff() > 1e-9;
}

/// Weighs a rotation as the way of a lever.
Vector6 weighed(const Vector6& way, double lever) {
  Vector6 w = way;
  w.tail<3>() *= lever;
  return w;
}

}  // namespace

std::string_view to_string(Hindrance hindrance) {
  return hindrance_names.name(hindrance);
}

Controller::Controller(const model::ArmModel& arm, ControllerOptions options)
    : arm_(arm),
      options_(std::move(options)),
      collision_(arm, options_.surroundings),
      X_AW_(options_.X_WA.inverse()),
      X_BE_(options_.X_EB.inverse()),
      bend_(0.5 * reach_bound(arm)),
      lever_(levers(arm, options_.surroundings.carried)) {
  start(arm.home);
}

void Controller::start(const Joints& q) {
  q_ = q;
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const model::ArmJoint& joint = arm_.joints[static_cast<std::size_t>(i)];
    q_[i] = std::clamp(q_[i], joint.lower, joint.upper);
  }
  v_.setZero(q_.size());
}

Joints Controller::braking(double dt) const {
  Joints v = v_;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const double most = joint_acceleration(arm_, i) * dt;
    v[i] -= std::clamp(v[i], -most, most);
  }
  return v;
}

Controller::Bounds Controller::bounds(double dt) const {
  Bounds bounds{v_, v_};
  const Joints rest = braking(dt);
  for (Eigen::Index i = 0; i < v_.size(); ++i) {
    const model::ArmJoint& joint = arm_.joints[static_cast<std::size_t>(i)];
    const double gain = joint.acceleration * dt;
    bounds.lower[i] = std::max(
        {-joint.velocity, v_[i] - gain, -brakeable(q_[i] - joint.lower, joint.acceleration, dt)});
    bounds.upper[i] = std::min(
        {joint.velocity, v_[i] + gain, brakeable(joint.upper - q_[i], joint.acceleration, dt)});
    // Rounding only: braking always keeps the limits.
    bounds.lower[i] = std::min(bounds.lower[i], rest[i]);
    bounds.upper[i] = std::max(bounds.upper[i], rest[i]);
  }
  return bounds;
}

/// Where a linear step is blind, a small turn along one of these directions may still bring E
/// nearer, as a bent elbow does from a stretched one. None: zero.
Joints Controller::escape(const Eigen::MatrixXd& directions, const Pose& X_AE,
                          const Pose& X_AE_wish) const {
  const double now = weighed(way_between(X_AE, X_AE_wish), options_.lever).squaredNorm();
  Joints best = Joints::Zero(q_.size());
  double least = now * (1 - 1e-4) - 1e-12;
  for (Eigen::Index k = 0; k < directions.cols(); ++k) {
    const Joints direction = directions.col(k);
    // Of two ways out that are as good, the one towards home: the same each time.
    const double side = direction.dot(arm_.home - q_) < 0 ? -1.0 : 1.0;
    for (const double sign : {side, -side}) {
      const Joints q = q_ + sign * probe * direction;
      if (!is_within_limits(arm_, q)) continue;
      const double then =
          weighed(way_between(end_pose(arm_, q), X_AE_wish), options_.lever).squaredNorm();
      if (then >= least * (sign == side ? 1 : 0.99)) continue;
      least = then;
      best = sign * probe * direction;
    }
  }
  return best;
}

/// Velocities that bring E along `way`, slowing down so that it stops there.
Controller::Aim Controller::towards(const Configuration& at, const Pose& X_AE_wish,
                                    const Vector6& velocity_A, double dt) const {
  const double lever = options_.lever;
  Vector6 way = way_between(at.X_AE, X_AE_wish);
  const double far = std::max(way.head<3>().norm() / trust_m, way.tail<3>().norm() / trust_rad);
  if (far > 1) way /= far;
  Jacobian J = jacobian(arm_, at);
  J.bottomRows<3>() *= lever;
  Aim aim;
  aim.metric = J.transpose() * J;
  const Eigen::SelfAdjointEigenSolver<Square> parts(aim.metric);
  aim.metric.diagonal().array() += 1e-3;
  const Joints pull = J.transpose() * weighed(way, lever),
               lead = J.transpose() * weighed(velocity_A, lever);
  const Eigen::Index count = q_.size(), idle = count - 6;
  const double edge = options_.singular * options_.singular;
  const auto strength_of = [&](Eigen::Index k) { return std::max(parts.eigenvalues()[k], 0.0); };
  // What no turn can bring nearer bends the ways that E goes: a step that does not know of it
  // swings about the nearest posture.
  Vector6 beyond = weighed(way, lever);
  for (Eigen::Index k = idle; k < count; ++k)
    if (strength_of(k) > 0.25 * edge) {
      const Vector6 moved = J * parts.eigenvectors().col(k);
      beyond -= moved * (moved.dot(beyond) / strength_of(k));
    }
  const double bent = bend_ * beyond.norm();
  Joints turn = Joints::Zero(count);
  aim.velocity.setZero(count);
  Eigen::Index blind = 0;
  for (Eigen::Index k = idle; k < count; ++k) {
    const Joints direction = parts.eigenvectors().col(k);
    const double strength = strength_of(k);
    const double damping = bent + (strength < edge ? options_.max_damping * options_.max_damping *
                                                         (1 - strength / edge)
                                                   : 0.0);
    turn += direction * (direction.dot(pull) / (strength + damping));
    aim.velocity += direction * (direction.dot(lead) / (strength + damping));
    blind += strength < 0.25 * edge ? 1 : 0;
  }
  if (blind > 0 && way.norm() > there_m)
    turn += escape(parts.eigenvectors().leftCols(idle + blind), at.X_AE, X_AE_wish);
  double share = 1 / dt;
  for (Eigen::Index i = 0; i < count; ++i) {
    const model::ArmJoint& joint = arm_.joints[static_cast<std::size_t>(i)];
    const double size = std::abs(turn[i]);
    const double most = std::min(joint.velocity, brakeable(size, calm * joint.acceleration, dt));
    if (size * share > most) share = most / size;
  }
  aim.velocity += share * turn;
  if (idle > 0) {
    // In a singularity the idle direction is one of many, and another each time.
    const double known = std::min(1.0, strength_of(idle) / edge);
    const Joints direction = parts.eigenvectors().col(0);
    aim.velocity += direction * (known * home_rate * direction.dot(arm_.home - q_));
  }
  return aim;
}

/// The same within the bounds, and slower towards what is near.
void Controller::keep_away(const Configuration& at, const Bounds& bounds, Aim& aim) const {
  std::vector<Row> rows;
  const Eigen::Index count = q_.size();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Joints unit = Joints::Unit(count, i);
    rows.push_back({unit, bounds.lower[i]});
    rows.push_back({-unit, -bounds.upper[i]});
  }
  const std::size_t boxes = rows.size();
  auto pairs = collision_.near(at, options_.slowing);
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.distance < b.distance; });
  if (pairs.size() > max_rows) pairs.resize(max_rows);
  for (const Collision::Pair& pair : pairs) {
    Row row{slope(arm_, at, pair.first, pair.p_A, pair.direction),
            -approach_rate * (pair.distance - options_.clearance - spare)};
    if (pair.second >= 0) row.c -= slope(arm_, at, pair.second, pair.p_B, pair.direction);
    rows.push_back(std::move(row));
  }
  const bool kept = std::all_of(rows.begin(), rows.end(),
                                [&](const Row& row) { return row.c.dot(aim.velocity) >= row.b; });
  if (!kept) aim.slowed = solve(aim.metric, rows, boxes, aim.velocity);
  aim.velocity = aim.velocity.cwiseMax(bounds.lower).cwiseMin(bounds.upper);
}

/// Can the arm go on like this for dt and then brake, without coming too near to anything? Looks at
/// as many postures on the way as distances ask for.
bool Controller::is_safe(const Joints& velocity, double dt) const {
  const Eigen::Index count = q_.size();
  double end = dt;
  for (Eigen::Index i = 0; i < count; ++i)
    end = std::max(end, dt + std::abs(velocity[i]) / joint_acceleration(arm_, i));
  const auto turns = [&](double t) {
    Joints way(count);
    for (Eigen::Index i = 0; i < count; ++i)
      way[i] = turned(velocity[i], joint_acceleration(arm_, i), dt, t);
    return way;
  };
  const auto clearance = [&](const Joints& way) {
    return collision_.clearance(forward(arm_, q_ + way), sight);
  };
  Joints way = Joints::Zero(count);
  double free = clearance(way) - options_.clearance;
  if (free < 0)  // already too near: anything that does not make it worse
    return clearance(turns(dt)) - options_.clearance >= free - 1e-9 &&
           clearance(turns(end)) - options_.clearance >= free - 1e-9;
  double t = 0;
  for (int look = 0; look < max_looks; ++look) {
    // Nothing moves by more than its levers allow. Steps that are shorter than half the clearance
    // would find nothing new.
    const double most = std::max(free, 0.5 * options_.clearance);
    const auto swept = [&](double until) { return (turns(until) - way).cwiseAbs().dot(lever_); };
    if (swept(end) <= free) return true;
    double low = t, high = end;
    if (swept(end) > most)
      for (int k = 0; k < 10; ++k) {
        const double middle = 0.5 * (low + high);
        (swept(middle) > most ? high : low) = middle;
      }
    else
      low = end;
    t = low;
    way = turns(t);
    free = clearance(way) - options_.clearance;
    if (free < 0) return false;
    if (t >= end) return true;
  }
  return false;
}

bool Controller::at_limit(const Joints& wanted) const {
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const model::ArmJoint& joint = arm_.joints[static_cast<std::size_t>(i)];
    const double room = wanted[i] > 0 ? joint.upper - q_[i] : q_[i] - joint.lower;
    if (room < 2e-3 && std::abs(wanted[i]) > at_rest * joint.velocity) return true;
  }
  return false;
}

Guidance Controller::answer(const std::optional<Pose>& X_AE_wish, Hindrance hindrance) const {
  const Pose X_AE = end_pose(arm_, q_);
  Guidance guidance{q_, v_, options_.X_WA * X_AE * options_.X_EB, 0, 0, hindrance};
  if (!X_AE_wish) return guidance;
  const Pose X_WB = options_.X_WA * *X_AE_wish * options_.X_EB;
  guidance.off_m = (X_WB.translation() - guidance.X_WB.translation()).norm();
  guidance.off_rad = way_between(guidance.X_WB, X_WB).tail<3>().norm();
  if (guidance.off_m < there_m && guidance.off_rad < there_rad)
    guidance.hindrance = Hindrance::none;
  return guidance;
}

Guidance Controller::brake(double dt) {
  dt = std::clamp(dt, 0.0, max_dt);
  v_ = braking(dt);
  q_ += v_ * dt;
  return answer(std::nullopt, Hindrance::no_wish);
}

Guidance Controller::step(const Wish& wish, double dt) {
  if (!is_finite(wish.X_WB) || !wish.velocity_W.allFinite() ||
      !(wish.X_WB.translation().norm() < 1e3))
    return brake(dt);
  const Pose X_AE_wish = X_AW_ * wish.X_WB * X_BE_;
  if (!(dt > 0)) return answer(X_AE_wish, Hindrance::on_the_way);
  dt = std::min(dt, max_dt);
  const Configuration at = forward(arm_, q_);
  // The velocity of B becomes that of E, which is carried along.
  Vector6 velocity_A;
  const Eigen::Matrix3d R_AW = X_AW_.linear();
  const Vector3d turning = R_AW * wish.velocity_W.tail<3>();
  const Vector3d p_BE_A = X_AE_wish.translation() - X_AW_ * wish.X_WB.translation();
  velocity_A << R_AW * wish.velocity_W.head<3>() + turning.cross(p_BE_A), turning;
  Aim aim = towards(at, X_AE_wish, velocity_A, dt);
  const bool ended = at_limit(aim.velocity);
  keep_away(at, bounds(dt), aim);
  const Joints rest = braking(dt);
  Joints next = rest;
  for (const double share : {1.0, 0.5, 0.2}) {
    const Joints tried = rest + share * (aim.velocity - rest);
    if (!is_safe(tried, dt)) {
      aim.slowed = true;
      continue;
    }
    next = tried;
    break;
  }
  v_ = next;
  q_ += v_ * dt;
  double speed = 0;
  for (Eigen::Index i = 0; i < v_.size(); ++i)
    speed = std::max(speed, std::abs(v_[i]) / arm_.joints[static_cast<std::size_t>(i)].velocity);
  const Hindrance why = aim.slowed        ? Hindrance::collision
                        : ended           ? Hindrance::joint_limit
                        : speed > at_rest ? Hindrance::on_the_way
                                          : Hindrance::reach;
  return answer(X_AE_wish, why);
}

}  // namespace prehend::arm
