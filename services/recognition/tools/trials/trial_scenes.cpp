#include "services/recognition/tools/trials/trial_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/named_values.hpp"
#include "common/base/random.hpp"
#include "services/recognition/core/geometry/silhouette.hpp"
#include "services/recognition/core/rendering/strangers.hpp"

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

void stand(model::Scene& scene, const model::CatalogueObject& object, double x, double y,
           Random& random) {
  scene.objects.push_back(
      {object.name, standing_pose(object.shape, {x, y, random.uniform(-pi, pi)})});
}

constexpr auto trial_names = named_values<Trial>({{Trial::open, "open"},
                                                  {Trial::clutter, "clutter"},
                                                  {Trial::light, "light"},
                                                  {Trial::occluded, "occluded"},
                                                  {Trial::empty, "empty"},
                                                  {Trial::strangers, "strangers"}});
}  // namespace

std::string to_string(Trial trial) {
  return std::string(trial_names.name(trial));
}

TrialScenes::TrialScenes(const model::Catalogue& catalogue, const CameraModel& camera,
                         std::uint64_t strangers_seed)
    : catalogue_(catalogue),
      camera_(camera),
      strangers_(strangers(16, strangers_seed)),
      renderer_(all(catalogue, strangers_)) {}

std::optional<TrialScene> TrialScenes::make(Trial trial, std::uint64_t seed) const {
  Random random(seed * 977 + static_cast<std::uint64_t>(trial));
  auto drawn =
      model::make_scene(catalogue_, 100000 + seed * 7 + static_cast<std::uint64_t>(trial), {});
  if (!drawn) return std::nullopt;
  TrialScene made{std::move(*drawn), {}, 0};
  model::Scene& scene = made.scene;
  made.target = scene.objects.front().name;
  switch (trial) {
    case Trial::open:
      break;
    case Trial::clutter:
      scatter(made, 4, random);
      break;
    case Trial::light: {
      scene.light.gain *=
          random.uniform() < 0.5 ? random.uniform(0.5, 0.7) : random.uniform(1.2, 1.5);
      const double warm = random.uniform(-0.2, 0.2);
      scene.light.colour = {1 + warm, 1, 1 - warm};
      scene.light.ambient = random.uniform(0.2, 0.8);
      break;
    }
    case Trial::occluded:
      if (!occlude(made, random)) return std::nullopt;
      break;
    case Trial::empty:
    case Trial::strangers:
      scene.objects.clear();
      made.target.clear();
      if (trial == Trial::strangers) scatter(made, 4, random);
      break;
  }
  if (!made.target.empty()) made.hidden = hidden_share(renderer_, scene, camera_);
  return made;
}

/// Puts strangers where they do not hide the target.
void TrialScenes::scatter(TrialScene& made, int count, Random& random) const {
  const auto known = all(catalogue_, strangers_);
  for (int tries = 0; tries < 300 && count > 0; ++tries) {
    const auto& object = strangers_[random.index(strangers_.size())];
    const double x = random.uniform(-0.4, 0.4), y = random.uniform(-0.25, 0.4);
    const double radius = model::half_extents(object.shape).head<2>().norm();
    if (room(made.scene, known, x, y, radius) < 0.015) continue;
    stand(made.scene, object, x, y, random);
    if (!made.target.empty() && hidden_share(renderer_, made.scene, camera_) > 0.03)
      made.scene.objects.pop_back();
    else
      --count;
  }
}

/// Puts a stranger before the target. False: none hides as much as it shall.
bool TrialScenes::occlude(TrialScene& made, Random& random) const {
  const auto known = all(catalogue_, strangers_);
  const Eigen::Vector3d target = made.scene.objects.front().X_WO.translation();
  const Eigen::Vector2d eye = camera_.X_WC.translation().head<2>();
  const Eigen::Vector2d towards = (eye - target.head<2>()).normalized();
  for (int tries = 0; tries < 200; ++tries) {
    const auto& object = strangers_[random.index(strangers_.size())];
    const double along = random.uniform(0.05, 0.2), across = random.uniform(-0.08, 0.08);
    const Eigen::Vector2d at =
        target.head<2>() + along * towards + across * Eigen::Vector2d(-towards.y(), towards.x());
    const double radius = model::half_extents(object.shape).head<2>().norm();
    if (room(made.scene, known, at.x(), at.y(), radius) < 0.002) continue;
    stand(made.scene, object, at.x(), at.y(), random);
    made.hidden = hidden_share(renderer_, made.scene, camera_);
    if (made.hidden >= 0.25 && made.hidden <= 0.35) return true;
    made.scene.objects.pop_back();
  }
  return false;
}

}  // namespace prehend::recognition
