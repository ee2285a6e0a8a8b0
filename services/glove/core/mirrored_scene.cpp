#include "services/glove/core/mirrored_scene.hpp"

#include <numbers>

namespace prehend::glove {

model::Scene mirrored(model::Scene scene, const Pose& X_WT) {
  const Eigen::DiagonalMatrix<double, 3> S(-1, 1, 1);  // what is symmetric is its own mirror image
  for (model::PlacedObject& object : scene.objects) {
    object.X_WO.linear() = S * object.X_WO.linear() * S;
    object.X_WO.translation().x() = 2 * X_WT.translation().x() - object.X_WO.translation().x();
  }
  scene.demonstrator.grasp_yaw = std::numbers::pi - scene.demonstrator.grasp_yaw;
  scene.demonstrator.carry_W = S * scene.demonstrator.carry_W;
  return scene;
}

}  // namespace prehend::glove
