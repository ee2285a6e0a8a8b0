#include "services/recognition/core/rendering/training_views.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::recognition {

std::vector<TrainingView> training_views(const Renderer& renderer,
                                         const model::CatalogueObject& object,
                                         const CameraModel& lab, int views, std::uint64_t seed) {
  constexpr double pi = std::numbers::pi;
  Random random(seed * 0x9e3779b97f4a7c15ull + object.appearance.seed);
  const Eigen::Vector3d half = model::half_extents(object.shape);
  const Eigen::Vector3d centre(0, 0, half.z());
  std::vector<TrainingView> made;
  for (int i = 0; i < views; ++i) {
    model::Scene scene;
    const double turn = 2 * pi * (i + random.uniform(0, 0.7)) / views;
    const Eigen::Matrix3d R = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    scene.objects.push_back({object.name, make_pose(centre, R)});
    const double azimuth = random.uniform(0, 2 * pi), height = random.uniform(0.5, 1.4);
    scene.light.to_light_W = {std::cos(azimuth) * std::cos(height),
                              std::sin(azimuth) * std::cos(height), std::sin(height)};
    // Half to nearly twice as bright as the lab, and as warm or cold as lamps are.
    scene.light.ambient = random.uniform(0.2, 0.8);
    scene.light.gain = std::exp(random.uniform(-0.9, 0.6));
    const double warm = random.uniform(-0.2, 0.2);
    scene.light.colour = {1 + warm, 1, 1 - warm};
    for (double& channel : scene.light.colour) channel *= random.uniform(0.95, 1.05);
    for (double& channel : scene.table_colour) channel = random.uniform(0.05, 0.95);
    scene.texture_seed = random.bits();

    CameraModel camera = lab;
    camera.distortion = {};
    const double distance = random.uniform(0.85, 1.4), elevation = random.uniform(0.4, 1.05);
    camera.X_WC = look_at(
        centre + distance * Eigen::Vector3d(0, -std::cos(elevation), std::sin(elevation)), centre);
    const double extent = 2.4 * half.norm() * camera.focal.x() / distance;
    camera.width = camera.height = std::clamp(static_cast<int>(extent), 48, 250);
    camera.centre = Eigen::Vector2d::Constant((camera.width - 1) / 2.0);

    RenderOptions options;
    options.noise_seed = random.bits();
    options.sensor_noise = random.uniform(1, 3);
    made.push_back({renderer.render(scene, camera, options), renderer.mask(scene, 0, camera)});
  }
  return made;
}

}  // namespace prehend::recognition
