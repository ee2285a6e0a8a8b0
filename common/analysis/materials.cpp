#include "materials.hpp"

#include <array>

namespace prehend::analysis {
namespace {

constexpr std::array<std::string_view, 6> names{"glass", "metal",  "plastic",
                                                "wood",  "rubber", "stone"};

// Symmetric; rows and columns in the order of Material.
constexpr double table[6][6] = {{0.2, 0.2, 0.2, 0.3, 1.0, 0.3}, {0.2, 0.2, 0.2, 0.3, 1.0, 0.4},
                                {0.2, 0.2, 0.3, 0.4, 1.0, 0.4}, {0.3, 0.3, 0.4, 0.4, 1.0, 0.6},
                                {1.0, 1.0, 1.0, 1.0, 2.0, 1.5}, {0.3, 0.4, 0.4, 0.6, 1.5, 0.7}};

}  // namespace

std::optional<Material> material_from_string(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<Material>(i);
  return std::nullopt;
}

std::string_view to_string(Material material) {
  return names[static_cast<std::size_t>(material)];
}

double friction(Material a, Material b) {
  return table[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
}

double torsion(Material a, Material b) {
  return a == Material::rubber || b == Material::rubber ? 0.002 : 0;
}

}  // namespace prehend::analysis
