#include "services/recognition/core/rendering/strangers.hpp"

#include <array>

#include "common/base/random.hpp"

namespace prehend::recognition {

std::vector<model::CatalogueObject> strangers(int count, std::uint64_t seed) {
  Random random(seed);
  const std::array<const char*, 5> patterns{"plain", "bands", "checks", "blobs", "label"};
  std::vector<model::CatalogueObject> made;
  for (int i = 0; i < count; ++i) {
    model::CatalogueObject object;
    object.name = "stranger " + std::to_string(i);
    const bool box = random.uniform() < 0.5;
    object.shape.kind = box ? model::ShapeKind::box : model::ShapeKind::cylinder;
    const double a = random.uniform(0.02, 0.045), b = random.uniform(0.02, 0.09);
    const double height = random.uniform(0.05, 0.2);
    object.shape.size = box ? Eigen::Vector3d(2 * a, 2 * b, height) : Eigen::Vector3d(a, a, height);
    object.mass = 0.2;
    object.material = "plastic";
    object.appearance.pattern = patterns[random.index(patterns.size())];
    object.appearance.seed = static_cast<unsigned>(500 + i);
    for (int k = 0; k < 4; ++k)
      object.appearance.colours.push_back(
          {random.uniform(0.05, 0.95), random.uniform(0.05, 0.95), random.uniform(0.05, 0.95)});
    made.push_back(object);
  }
  return made;
}

model::CatalogueObject imagined(const std::string& name, const model::Shape& shape, double mass) {
  std::uint64_t seed = 14695981039346656037u;  // FNV-1a: the same name looks the same everywhere
  for (const char c : name) seed = (seed ^ static_cast<unsigned char>(c)) * 1099511628211u;
  model::CatalogueObject made = strangers(1, seed).front();
  made.name = name;
  made.shape = shape;
  made.mass = mass;
  return made;
}

}  // namespace prehend::recognition
