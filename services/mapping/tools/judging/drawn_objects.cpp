#include "services/mapping/tools/judging/drawn_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::mapping {
namespace {

using model::ShapeKind;

constexpr double narrowest = 0.010, widest = 0.090;  // m, between the fingers
constexpr double lowest = 0.050, highest = 0.220;    // m
constexpr double smallest_ball = 0.040;              // m; smaller ones lie too low to be had
constexpr double deepest = 0.150;                    // m, of a box along its longer side

model::Shape drawn_shape(Random& random) {
  constexpr std::array kinds{ShapeKind::cylinder, ShapeKind::box, ShapeKind::sphere,
                             ShapeKind::cone};
  const ShapeKind kind = kinds[random.index(kinds.size())];
  const double width = random.uniform(narrowest, widest), radius = width / 2;
  const double height = random.uniform(std::max(lowest, 0.7 * width), highest);
  if (kind == ShapeKind::sphere)
    return {kind, Eigen::Vector3d::Constant(random.uniform(smallest_ball, widest) / 2)};
  if (kind == ShapeKind::cylinder) return {kind, {radius, radius, height}};
  if (kind == ShapeKind::box) return {kind, {width, random.uniform(width, deepest), height}};
  const double other = radius * random.uniform(0.5, 1);
  return random.uniform() < 0.5 ? model::Shape{kind, {radius, other, height}}
                                : model::Shape{kind, {other, radius, height}};
}

}  // namespace

model::Catalogue drawn_objects(int count, std::uint64_t seed) {
  constexpr std::array materials{"plastic", "wood", "metal"};
  Random random(seed);
  std::vector<model::CatalogueObject> made;
  for (int i = 0; i < count; ++i) {
    model::CatalogueObject object;
    object.shape = drawn_shape(random);
    object.name = fmt::format("{} {}", to_string(object.shape.kind), i);
    const double density = random.uniform(200, 800);  // kg/m³: what is hollow, and what is not
    object.mass = std::clamp(density * volume(object.shape), 0.03, 0.6);
    object.material = materials[random.index(materials.size())];
    made.push_back(std::move(object));
  }
  return model::Catalogue(std::move(made));
}

}  // namespace prehend::mapping
