#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/world.hpp"
#include "common/model/catalogue.hpp"

namespace prehend::grasping {

/// Without its mesh: what bounds it.
Body primitive_of(const model::CatalogueObject& object);

/// The objects of a catalogue as bodies; made once, since meshes take a moment to be cut.
class CatalogueBodies {
 public:
  /// Fails on meshes that cannot be cut into convex parts.
  static Expected<CatalogueBodies> create(const model::Catalogue& catalogue);

  /// In the catalogue's order.
  const std::vector<Body>& bodies() const { return bodies_; }
  /// nullptr if there is none of that name.
  const Body* find(std::string_view name) const;

  /// An object of that name as it is seen: of that shape and size, with the rest from the
  /// catalogue, and its mesh as large as it is seen, if it looks like it. What is not in the
  /// catalogue is of plastic and as heavy as things of its size are.
  Body seen(const std::string& name, const model::Shape& shape) const;

 private:
  std::vector<Body> bodies_;
};

}  // namespace prehend::grasping
