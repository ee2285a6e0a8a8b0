#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/model/catalogue.hpp"
#include "common/model/scene.hpp"

namespace prehend::tasks {

struct TableOptions {
  std::vector<std::string> objects;           // that stand on it, names in the catalogue
  std::vector<Eigen::Vector2d> free = {};     // m: nothing stands near these places
  double apart = 0.27;                        // m, between two of them
  double half_width = 0.4, half_depth = 0.3;  // m, of the part of the table that is used
  double middle = 0;                          // m, y of that part's middle
};

/// On that part of the table that the Puma reaches, where it stands by default. Things stand closer
/// together there.
void reachable(TableOptions& options);

/// A scene with these objects, drawn from a seed. Fails where they do not fit.
Expected<model::Scene> drawn_table(const model::Catalogue& catalogue, std::uint64_t seed,
                                   const TableOptions& options);

/// A place on the table that is free in the scene, m.
Expected<Eigen::Vector2d> free_place(const model::Scene& scene, std::uint64_t seed,
                                     const TableOptions& options);

}  // namespace prehend::tasks
