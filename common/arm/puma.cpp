#include "common/arm/puma.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::arm {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
constexpr double same = 1e-9;  // m, rad: a file's numbers

Pose twisted(const Vector3d& p, double alpha) {
  return make_pose(p, Eigen::Quaterniond(AngleAxisd(alpha, Vector3d::UnitX())));
}

/// acos, or asin, of what rounding may have brought beyond 1. None: truly beyond.
std::optional<double> bounded(double ratio) {
  if (!(std::abs(ratio) <= 1 + 1e-12)) return std::nullopt;
  return std::clamp(ratio, -1.0, 1.0);
}

/// Rotation of frame 3 (behind joint 3) in frame 0.
Matrix3d R_03(double q1, double q23) {
  return (AngleAxisd(q1, Vector3d::UnitZ()) * AngleAxisd(pi / 2, Vector3d::UnitX()) *
          AngleAxisd(q23, Vector3d::UnitZ()) * AngleAxisd(-pi / 2, Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Both ways to turn the wrist: M = Rz(q4) Ry(-q5) Rz(q6).
void add_wrists(const Vector3d& shoulder, const Matrix3d& M, double near4,
                std::vector<Joints>& found) {
  const double s = std::hypot(M(0, 2), M(1, 2));
  const double b = std::atan2(s, M(2, 2));
  Joints q(6);
  q.head<3>() = shoulder;
  if (s < 1e-12) {  // joints 4 and 6 turn about the same line
    q[3] = near4;
    q[5] = b < 1 ? std::atan2(M(1, 0), M(0, 0)) - near4     // M = Rz(q4 + q6)
                 : near4 - std::atan2(-M(1, 0), -M(0, 0));  // M = Rz(q4 - q6) Ry(π)
    q[4] = -b;
    found.push_back(q.unaryExpr([](double angle) { return wrapped(angle); }));
    return;
  }
  for (const double sign : {1.0, -1.0}) {
    q[3] = std::atan2(sign * M(1, 2), sign * M(0, 2));
    q[4] = -sign * b;
    q[5] = std::atan2(sign * M(2, 1), -sign * M(2, 0));
    found.push_back(q.unaryExpr([](double angle) { return wrapped(angle); }));
  }
}

}  // namespace

std::optional<PumaForm> puma_form(const model::ArmModel& arm) {
  if (arm.joints.size() != 6) return std::nullopt;
  for (const model::ArmJoint& joint : arm.joints)
    if ((joint.axis_J - Vector3d::UnitZ()).norm() > same) return std::nullopt;
  const auto& joints = arm.joints;
  const PumaForm form{joints[2].X_PJ.translation().x(), joints[3].X_PJ.translation().x(),
                      joints[3].X_PJ.translation().z(), joints[4].X_PJ.translation().z()};
  const Pose expected[] = {twisted(Vector3d::Zero(), pi / 2), twisted({form.a2, 0, 0}, 0),
                           twisted({form.a3, 0, form.d3}, -pi / 2),
                           twisted({0, 0, form.d4}, pi / 2), twisted(Vector3d::Zero(), -pi / 2)};
  for (std::size_t i = 0; i < 5; ++i)
    if ((joints[i + 1].X_PJ.matrix() - expected[i].matrix()).cwiseAbs().maxCoeff() > same)
      return std::nullopt;
  if (std::abs(form.a2) < 1e-3 || std::hypot(form.a3, form.d4) < 1e-3) return std::nullopt;
  return form;
}

std::vector<Joints> solve_puma(const model::ArmModel& arm, const PumaForm& form, const Pose& X_AE,
                               const Joints& near) {
  const Pose X_06 = arm.joints[0].X_PJ.inverse() * X_AE * arm.X_LE.inverse();
  const Vector3d p = X_06.translation();  // of the wrist
  std::vector<Joints> found;
  const double r = std::hypot(p.x(), p.y());
  if (r < 1e-12) {
    // The wrist is on the first axis: only without an offset, and then any q1 will do.
    if (std::abs(form.d3) > 1e-12) return found;
  }
  const auto side = r < 1e-12 ? std::optional(0.0) : bounded(form.d3 / r);
  if (!side) return found;
  const double azimuth = r < 1e-12 ? near[0] : std::atan2(p.y(), p.x());
  const double length3 = std::hypot(form.a3, form.d4);
  for (const double q1 : {azimuth + std::asin(*side), azimuth + pi - std::asin(*side)}) {
    const double x = p.x() * std::cos(q1) + p.y() * std::sin(q1), y = p.z();
    const double k = (x * x + y * y - form.a2 * form.a2 - length3 * length3) / (2 * form.a2);
    const auto elbow = bounded(k / length3);
    if (!elbow) continue;
    for (const double bend : {std::acos(*elbow), -std::acos(*elbow)}) {
      const double q3 = -std::atan2(form.d4, form.a3) + bend;
      const double u = form.a3 * std::cos(q3) - form.d4 * std::sin(q3);
      const double w = form.a3 * std::sin(q3) + form.d4 * std::cos(q3);
      const double q2 = std::atan2(y, x) - std::atan2(w, form.a2 + u);
      add_wrists({q1, q2, q3}, R_03(q1, q2 + q3).transpose() * X_06.linear(), near[3], found);
    }
  }
  return found;
}

}  // namespace prehend::arm
