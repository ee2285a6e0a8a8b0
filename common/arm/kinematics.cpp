#include "common/arm/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::arm {
namespace {

using Eigen::Vector3d;

constexpr double turn = 2 * std::numbers::pi;
constexpr double limit_tolerance = 1e-9;  // rad, of what was computed to be a limit

/// Values of a joint that differ from q by whole turns and are within its limits, rising.
std::vector<double> turns_of(const model::ArmJoint& joint, double q) {
  std::vector<double> found;
  const double first = q - turn * std::floor((q - joint.lower + limit_tolerance) / turn);
  for (double value = first; value <= joint.upper + limit_tolerance; value += turn)
    found.push_back(std::clamp(value, joint.lower, joint.upper));
  return found;
}

}  // namespace

Configuration forward(const model::ArmModel& arm, const Joints& q) {
  Configuration at;
  at.X_AL[0].setIdentity();
  const std::size_t count = arm.joints.size();
  for (std::size_t i = 0; i < count; ++i) {
    const model::ArmJoint& joint = arm.joints[i];
    Pose& X = at.X_AL[i + 1];
    X = at.X_AL[i] * joint.X_PJ;
    X.linear() *=
        Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], joint.axis_J).toRotationMatrix();
  }
  at.X_AE = at.X_AL[count] * arm.X_LE;
  return at;
}

Pose end_pose(const model::ArmModel& arm, const Joints& q) {
  return forward(arm, q).X_AE;
}

Jacobian jacobian(const model::ArmModel& arm, const Configuration& at) {
  const std::size_t count = arm.joints.size();
  Jacobian J(6, static_cast<Eigen::Index>(count));
  const Vector3d p_AE = at.X_AE.translation();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d axis = at.X_AL[i + 1].linear() * arm.joints[i].axis_J;
    const auto column = static_cast<Eigen::Index>(i);
    J.col(column).head<3>() = axis.cross(p_AE - at.X_AL[i + 1].translation());
    J.col(column).tail<3>() = axis;
  }
  return J;
}

Vector6 way_between(const Pose& A, const Pose& B) {
  Vector6 way;
  way.head<3>() = B.translation() - A.translation();
  const Eigen::Quaterniond q(Eigen::Matrix3d(B.linear() * A.linear().transpose()));
  // atan2 keeps full precision at every angle; the sign takes the shorter way round.
  const double s = q.vec().norm();
  const double angle = 2 * std::atan2(s, std::abs(q.w()));
  if (s < 1e-12)
    way.tail<3>() = (q.w() < 0 ? -2.0 : 2.0) * q.vec();
  else
    way.tail<3>() = ((q.w() < 0 ? -angle : angle) / s) * q.vec();
  return way;
}

double reach_bound(const model::ArmModel& arm) {
  double length = (arm.joints[0].X_PJ.translation() - arm.X_AS.translation()).norm();
  for (std::size_t i = 1; i < arm.joints.size(); ++i)
    length += arm.joints[i].X_PJ.translation().norm();
  return length + arm.X_LE.translation().norm();
}

bool is_within_limits(const model::ArmModel& arm, const Joints& q) {
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const double value = q[static_cast<Eigen::Index>(i)];
    if (!(value >= arm.joints[i].lower - limit_tolerance &&
          value <= arm.joints[i].upper + limit_tolerance))
      return false;
  }
  return true;
}

Joints turned_into_limits(const model::ArmModel& arm, const Joints& q) {
  Joints turned = q;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    double& value = turned[static_cast<Eigen::Index>(i)];
    const std::vector<double> values = turns_of(arm.joints[i], value);
    const auto nearest = std::min_element(
        values.begin(), values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    value = nearest == values.end() ? wrapped(value) : *nearest;
  }
  return turned;
}

std::vector<Joints> turns_within_limits(const model::ArmModel& arm, const Joints& q) {
  constexpr std::size_t most = 256;
  std::vector<Joints> found{q};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    std::vector<Joints> more;
    const auto row = static_cast<Eigen::Index>(i);
    for (const Joints& posture : found)
      for (const double value : turns_of(arm.joints[i], q[row])) {
        Joints turned = posture;
        turned[row] = value;
        if (more.size() < most) more.push_back(turned);
      }
    found = std::move(more);
  }
  std::stable_sort(found.begin(), found.end(), [&](const Joints& a, const Joints& b) {
    return (a - q).lpNorm<1>() < (b - q).lpNorm<1>();
  });
  return found;
}

double wrapped(double angle) {
  const double rest = angle - turn * std::round(angle / turn);
  return rest <= -std::numbers::pi ? rest + turn : rest;
}

}  // namespace prehend::arm
