#pragma once

#include <optional>
#include <string_view>

namespace prehend::analysis {

/// What a surface is made of.
enum class Material { glass, metal, plastic, wood, rubber, stone };

std::optional<Material> material_from_string(std::string_view name);
std::string_view to_string(Material material);

/// Static Coulomb friction coefficient between two materials (the table that GraspIt! uses).
double friction(Material a, Material b);

}  // namespace prehend::analysis
