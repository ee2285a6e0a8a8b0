#include "services/recognition/core/geometry/camera_model.hpp"

#include <cmath>

namespace prehend::recognition {
namespace {

Eigen::Vector2d distort(const Eigen::Vector2d& n, const std::array<double, 5>& k) {
  const double r2 = n.squaredNorm();
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {n.x() * radial + 2 * k[2] * n.x() * n.y() + k[3] * (r2 + 2 * n.x() * n.x()),
          n.y() * radial + k[2] * (r2 + 2 * n.y() * n.y()) + 2 * k[3] * n.x() * n.y()};
}

}  // namespace

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d p_C = X_WC.linear().transpose() * (p_W - X_WC.translation());
  if (!(p_C.z() > 0.05)) return std::nullopt;
  const Eigen::Vector2d n = distort(p_C.head<2>() / p_C.z(), distortion);
  return Eigen::Vector2d(n.cwiseProduct(focal) + centre);
}

Eigen::Vector3d CameraModel::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d seen = (pixel - centre).cwiseQuotient(focal);
  Eigen::Vector2d n = seen;
  const bool distorted = distortion != std::array<double, 5>{};
  // Fixed-point iteration; converges for the mild distortion of ordinary lenses.
  for (int i = 0; distorted && i < 8; ++i) n += seen - distort(n, distortion);
  return (X_WC.linear() * Eigen::Vector3d(n.x(), n.y(), 1)).normalized();
}

std::optional<Eigen::Vector3d> CameraModel::on_level(const Eigen::Vector2d& pixel,
                                                     double level) const {
  const Eigen::Vector3d d = ray(pixel);
  if (std::abs(d.z()) < 1e-6) return std::nullopt;
  const double t = (level - X_WC.translation().z()) / d.z();
  if (t <= 0) return std::nullopt;
  return Eigen::Vector3d(X_WC.translation() + t * d);
}

CameraModel CameraModel::scaled(double factor) const {
  CameraModel made = *this;
  made.width = static_cast<int>(std::lround(width * factor));
  made.height = static_cast<int>(std::lround(height * factor));
  made.focal *= factor;
  made.centre = (centre.array() + 0.5) * factor - 0.5;
  return made;
}

Expected<CameraModel> checked_camera(const CameraModel& camera) {
  const auto wrong = [](const char* what) {
    return fail(what, "camera", "see [camera] in lab.toml");
  };
  if (camera.width < 16 || camera.height < 16 || camera.width > 8192 || camera.height > 8192)
    return wrong("width and height must lie between 16 and 8192 px");
  if (!camera.focal.allFinite() || camera.focal.minCoeff() < 1)
    return wrong("focal must be two numbers above 1 px");
  if (!camera.centre.allFinite()) return wrong("centre must be two finite numbers");
  for (const double k : camera.distortion)
    if (!std::isfinite(k) || std::abs(k) > 10) return wrong("distortion is not finite or above 10");
  if (!is_finite(camera.X_WC)) return wrong("X_WC is not finite");
  return camera;
}

Pose look_at(const Eigen::Vector3d& p_W, const Eigen::Vector3d& target_W) {
  const Eigen::Vector3d z = (target_W - p_W).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return make_pose(p_W, R);
}

}  // namespace prehend::recognition
