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

/// Greatest moment about the normal per unit of normal force, m: a pad of rubber is a soft finger
/// that touches in a patch of about 3 mm radius (μ = 1), everything else touches in a point (0).
double torsion(Material a, Material b);

}  // namespace prehend::analysis
