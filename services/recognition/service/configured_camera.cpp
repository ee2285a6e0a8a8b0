#include <algorithm>

#include "services/recognition/service/service.hpp"

namespace prehend::recognition {

Expected<CameraModel> configured_camera(const service::Config& config) {
  CameraModel camera;
  const auto size = [&](std::string_view key) {
    return static_cast<int>(std::clamp<std::int64_t>(config.integer(key), -1, 1 << 20));
  };
  camera.width = size("camera.width");
  camera.height = size("camera.height");
  const auto wrong = [](const char* key, const char* what) {
    return fail(what, key, "see [camera] in lab.toml");
  };
  const auto& focal = config.numbers("camera.focal");
  const auto& centre = config.numbers("camera.centre");
  const auto& distortion = config.numbers("camera.distortion");
  const auto& X = config.numbers("camera.X_WC");
  if (focal.size() != 2) return wrong("camera.focal", "needs two numbers");
  if (centre.size() != 2) return wrong("camera.centre", "needs two numbers");
  if (distortion.size() != 5) return wrong("camera.distortion", "needs five numbers");
  if (X.size() != 7)
    return wrong("camera.X_WC", "needs seven numbers: x y z in m, then the quaternion w x y z");
  camera.focal = {focal[0], focal[1]};
  camera.centre = {centre[0], centre[1]};
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  auto pose = checked_pose({X[0], X[1], X[2]}, Eigen::Quaterniond(X[3], X[4], X[5], X[6]));
  if (!pose) return wrong("camera.X_WC", "is no pose");
  camera.X_WC = *pose;
  return checked_camera(camera);
}

}  // namespace prehend::recognition
