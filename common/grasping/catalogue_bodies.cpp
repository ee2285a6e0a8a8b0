#include "common/grasping/catalogue_bodies.hpp"

#include <algorithm>

#include "common/grasping/mesh_body.hpp"

namespace prehend::grasping {
namespace {

constexpr double density = 300;  // kg/m³, of what is in no catalogue: things are hollow
constexpr double lightest = 0.03, heaviest = 0.6;  // kg
constexpr double other_size = 0.25;  // share: what is seen so much larger is not this mesh

}  // namespace

Body primitive_of(const model::CatalogueObject& object) {
  return {object.name, object.shape, object.mass, object.material, {}, {}};
}

Expected<CatalogueBodies> CatalogueBodies::create(const model::Catalogue& catalogue) {
  CatalogueBodies made;
  for (const model::CatalogueObject& object : catalogue.objects()) {
    Body body = primitive_of(object);
    if (object.mesh) {
      auto solid = solid_of(*object.mesh);
      if (!solid) return fail(solid.error().what, object.name, solid.error().hint);
      body.mesh = std::move(*solid);
    }
    made.bodies_.push_back(std::move(body));
  }
  return made;
}

const Body* CatalogueBodies::find(std::string_view name) const {
  const auto found = std::ranges::find(bodies_, name, &Body::name);
  return found == bodies_.end() ? nullptr : &*found;
}

Body CatalogueBodies::seen(const std::string& name, const model::Shape& shape) const {
  Body body;
  body.name = name;
  body.shape = shape;
  const Body* known = find(name);
  if (!known) {
    body.mass = std::clamp(density * model::volume(shape), lightest, heaviest);
    body.material = "plastic";
    return body;
  }
  body.mass = known->mass;
  body.material = known->material;
  if (!known->mesh || known->shape.kind != shape.kind) return body;
  const Eigen::Vector3d factor =
      model::half_extents(shape).cwiseQuotient(model::half_extents(known->shape));
  if (((factor.array() - 1).abs() <= other_size).all()) body.mesh = scaled(*known->mesh, factor);
  return body;
}

}  // namespace prehend::grasping
