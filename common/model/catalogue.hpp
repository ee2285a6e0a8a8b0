#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/mesh.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

/// How an object looks, for rendering: bands of colour around it and a printed label.
struct Appearance {
  std::vector<Eigen::Vector3d> colours;  // sRGB, 0..1; at least one
  std::string pattern;                   // plain, bands, checks, blobs, label
  unsigned seed = 0;                     // of the pattern's details
};

/// An everyday object, standing upright: z of its frame is up.
struct CatalogueObject {
  std::string name;
  Shape shape;  // what bounds it, if it has a mesh
  /// What it is like more exactly, its origin in the middle of the box that bounds it; or none.
  std::shared_ptr<const Mesh> mesh;
  std::filesystem::path mesh_file;  // of the mesh, as the catalogue names it: beside itself
  double mass = 0;                  // kg
  std::string material;             // one of the friction table (see analysis/materials.hpp)
  Appearance appearance;
};

/// The objects that the lab knows, from models/objects/catalogue.toml.
class Catalogue {
 public:
  Catalogue() = default;
  /// Of names that differ.
  explicit Catalogue(std::vector<CatalogueObject> objects) : objects_(std::move(objects)) {}
  static Expected<Catalogue> load(const std::filesystem::path& file);

  const std::vector<CatalogueObject>& objects() const { return objects_; }
  /// nullptr if there is none of that name.
  const CatalogueObject* find(std::string_view name) const;

 private:
  std::vector<CatalogueObject> objects_;
};

}  // namespace prehend::model
