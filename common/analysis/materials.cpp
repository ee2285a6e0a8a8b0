#include "common/analysis/materials.hpp"

#include <array>

#include "common/base/named_values.hpp"

namespace prehend::analysis {
namespace {

constexpr auto material_names = named_values<Material>({{Material::glass, "glass"},
                                                        {Material::metal, "metal"},
                                                        {Material::plastic, "plastic"},
                                                        {Material::wood, "wood"},
                                                        {Material::rubber, "rubber"},
                                                        {Material::stone, "stone"}});

// Symmetric; rows and columns in the order of Material.
constexpr double table[6][6] = {{0.2, 0.2, 0.2, 0.3, 1.0, 0.3}, {0.2, 0.2, 0.2, 0.3, 1.0, 0.4},
                                {0.2, 0.2, 0.3, 0.4, 1.0, 0.4}, {0.3, 0.3, 0.4, 0.4, 1.0, 0.6},
                                {1.0, 1.0, 1.0, 1.0, 2.0, 1.5}, {0.3, 0.4, 0.4, 0.6, 1.5, 0.7}};

}  // namespace

std::optional<Material> material_from_string(std::string_view name) {
  return material_names.value(name);
}

std::string_view to_string(Material material) {
  return material_names.name(material);
}

double friction(Material a, Material b) {
  return table[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
}

double torsion(Material a, Material b) {
  return a == Material::rubber || b == Material::rubber ? 0.002 : 0;
}

}  // namespace prehend::analysis
