#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <memory>
#include <optional>
#include <vector>

#include "common/analysis/materials.hpp"
#include "common/model/shape.hpp"

class btCollisionShape;

namespace prehend::grasping {

/// What a collider is made of and whose it is.
struct Surface {
  analysis::Material material = analysis::Material::wood;
  std::optional<double> friction;  // against everything, instead of the material's
  int body = -1;                   // number of the body; -1: table or hand
  int link = -1;                   // of the hand; -1: not the hand
};

/// Bullet's shape of a solid about its centre; without the thick margin that Bullet likes.
std::unique_ptr<btCollisionShape> make_shape(const model::Shape& shape);

/// The same of a convex solid with these corners.
std::unique_ptr<btCollisionShape> make_shape(const std::vector<Eigen::Vector3d>& corners);

/// Gives the collider a surface, whose address must stay. Friction between two colliders is that of
/// their two surfaces.
void make_touchable(btCollisionObject& collider, Surface& surface);

const Surface& surface_of(const btCollisionObject* collider);

}  // namespace prehend::grasping
