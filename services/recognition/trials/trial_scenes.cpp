#include "trial_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <prehend/base/random.hpp>
#include <prehend/recognition_geometry/silhouette.hpp>
#include <prehend/recognition_rendering/strangers.hpp>

namespace prehend::recognition {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<model::CatalogueObject> all(const model::Catalogue& catalogue,
                                        const std::vector<model::CatalogueObject>& strangers) {
  std::vector<model::CatalogueObject> made = catalogue.objects();
  made.insert(made.end(), strangers.begin(), strangers.end());
  return made;
}

int pixels(const Plane& mask) {
  return static_cast<int>(std::count(mask.values.begin(), mask.values.end(), 1));
}

/// Share of the first object's pixels that the others stand before. On a small picture: exact
/// enough.
double hidden_share(const Renderer& renderer, const model::Scene& scene,
                    const CameraModel& camera) {
  const CameraModel small = camera.scaled(0.25);
  model::Scene alone = scene;
  alone.objects.resize(1);
  const int whole = pixels(renderer.mask(alone, 0, small));
  return whole > 0 ? 1 - static_cast<double>(pixels(renderer.mask(scene, 0, small))) / whole : 1;
}

/// Distance on the table between an object at (x, y) and the nearest of the scene's, m; objects as
/// circles around their bases.
double room(const model::Scene& scene, const std::vector<model::CatalogueObject>& known, double x,
            double y, double radius) {
  double least = 1e9;
  for (const model::PlacedObject& placed : scene.objects)
    for (const model::CatalogueObject& object : known)
      if (object.name == placed.name) {
        const Eigen::Vector3d p = placed.X_WO.translation();
        least = std::min(least, std::hypot(p.x() - x, p.y() - y) - radius -
                                    model::half_extents(object.shape).head<2>().norm());
      }
  return least;
}

}  // namespace

std::string to_string(Trial trial) {
  switch (trial) {
    case Trial::open:
      return "open";
    case Trial::clutter:
      return "clutter";
    case Trial::light:
      return "light";
    case Trial::occluded:
      return "occluded";
    case Trial::empty:
      return "empty";
    case Trial::strangers:
      return "strangers";
  }
  return "";
}

TrialScenes::TrialScenes(const model::Catalogue& catalogue, const CameraModel& camera,
                         std::uint64_t strangers_seed)
    : catalogue_(catalogue),
      camera_(camera),
      strangers_(strangers(16, strangers_seed)),
      renderer_(all(catalogue, strangers_)) {}

std::optional<TrialScene> TrialScenes::make(Trial trial, std::uint64_t seed) const {
  Random random(seed * 977 + static_cast<std::uint64_t>(trial));
  const auto known = all(catalogue_, strangers_);
  auto drawn =
      model::make_scene(catalogue_, 100000 + seed * 7 + static_cast<std::uint64_t>(trial), {});
  if (!drawn) return std::nullopt;
  TrialScene made{std::move(*drawn), {}, 0};
  model::Scene& scene = made.scene;
  made.target = scene.objects.front().name;
  const auto stand = [&](const model::CatalogueObject& object, double x, double y) {
    scene.objects.push_back(
        {object.name, standing_pose(object.shape, {x, y, random.uniform(-pi, pi)})});
  };
  const auto scatter = [&](int count) {
    for (int tries = 0; tries < 300 && count > 0; ++tries) {
      const auto& object = strangers_[random.index(strangers_.size())];
      const double x = random.uniform(-0.4, 0.4), y = random.uniform(-0.25, 0.4);
      const double radius = model::half_extents(object.shape).head<2>().norm();
      if (room(scene, known, x, y, radius) < 0.015) continue;
      stand(object, x, y);
      if (!made.target.empty() && hidden_share(renderer_, scene, camera_) > 0.03)
        scene.objects.pop_back();
      else
        --count;
    }
  };
  switch (trial) {
    case Trial::open:
      break;
    case Trial::clutter:
      scatter(4);
      break;
    case Trial::light: {
      scene.light.gain *=
          random.uniform() < 0.5 ? random.uniform(0.5, 0.7) : random.uniform(1.2, 1.5);
      const double warm = random.uniform(-0.2, 0.2);
      scene.light.colour = {1 + warm, 1, 1 - warm};
      scene.light.ambient = random.uniform(0.2, 0.8);
      break;
    }
    case Trial::occluded: {
      const Eigen::Vector3d target = scene.objects.front().X_WO.translation();
      const Eigen::Vector2d eye = camera_.X_WC.translation().head<2>();
      const Eigen::Vector2d towards = (eye - target.head<2>()).normalized();
      for (int tries = 0;; ++tries) {
        if (tries == 200) return std::nullopt;
        const auto& object = strangers_[random.index(strangers_.size())];
        const double along = random.uniform(0.05, 0.2), across = random.uniform(-0.08, 0.08);
        const Eigen::Vector2d at = target.head<2>() + along * towards +
                                   across * Eigen::Vector2d(-towards.y(), towards.x());
        const double radius = model::half_extents(object.shape).head<2>().norm();
        if (room(scene, known, at.x(), at.y(), radius) < 0.002) continue;
        stand(object, at.x(), at.y());
        made.hidden = hidden_share(renderer_, scene, camera_);
        if (made.hidden >= 0.25 && made.hidden <= 0.35) break;
        scene.objects.pop_back();
      }
      break;
    }
    case Trial::empty:
    case Trial::strangers:
      scene.objects.clear();
      made.target.clear();
      if (trial == Trial::strangers) scatter(4);
      break;
  }
  if (!made.target.empty()) made.hidden = hidden_share(renderer_, scene, camera_);
  return made;
}

}  // namespace prehend::recognition
