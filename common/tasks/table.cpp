#include "common/tasks/table.hpp"

#include <algorithm>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::tasks {

namespace {

constexpr int max_draws = 2000;

using Places = std::vector<Eigen::Vector2d>;

Expected<Eigen::Vector2d> draw(Random& random, const Places& taken, const TableOptions& options) {
  for (int n = 0; n < max_draws; ++n) {
    const double x = random.uniform(-options.half_width, options.half_width),
                 y = options.middle + random.uniform(-options.half_depth, options.half_depth);
    const Eigen::Vector2d place(x, y);
    if (std::none_of(taken.begin(), taken.end(), [&](const Eigen::Vector2d& other) {
          return (other - place).norm() < options.apart;
        }))
      return place;
  }
  return fail("there is no room on the table", "scene", "fewer objects");
}

}  // namespace

void reachable(TableOptions& options) {
  options.half_width = 0.3;
  options.half_depth = 0.17;
  options.middle = -0.12;
  options.apart = 0.22;
}

Expected<model::Scene> drawn_table(const model::Catalogue& catalogue, std::uint64_t seed,
                                   const TableOptions& options) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 17);
  // A hard order may leave no room for the last one: then all are drawn anew.
  for (int n = 0; n < 50; ++n) {
    model::Scene scene;
    Places taken = options.free;
    bool all = true;
    for (const std::string& name : options.objects) {
      const model::CatalogueObject* known = catalogue.find(name);
      if (!known) return wrong_use("is not in the catalogue", name, "see models/objects");
      const auto place = draw(random, taken, options);
      const double turn = random.uniform(-std::numbers::pi, std::numbers::pi);
      if (!(all = place.has_value())) break;
      taken.push_back(*place);
      scene.objects.push_back(
          {name, make_pose({place->x(), place->y(), model::half_extents(known->shape).z()},
                           Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix())});
    }
    if (!all) continue;
    scene.demonstrator.hand_scale = std::clamp(1 + random.normal(0.06), 0.86, 1.14);
    scene.demonstrator.grasp_yaw = -std::numbers::pi / 2 + random.uniform(-0.6, 0.6);
    return scene;
  }
  return fail("there is no room on the table", "scene", "fewer objects");
}

Expected<Eigen::Vector2d> free_place(const model::Scene& scene, std::uint64_t seed,
                                     const TableOptions& options) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 29);
  Places taken = options.free;
  for (const model::PlacedObject& placed : scene.objects)
    taken.push_back(placed.X_WO.translation().head<2>());
  return draw(random, taken, options);
}

}  // namespace prehend::tasks
