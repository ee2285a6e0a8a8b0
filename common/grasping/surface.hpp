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
  int body = -1;                   // number of the body; -1: table or a hand
  int hand = -1;                   // number of the hand; -1: none
  int link = -1;                   // of the hand; -1: not a hand
};

/// m, that Bullet adds to what is made of corners; its default of 0.04 is far too much here.
inline constexpr double collision_margin = 0.0005;

/// Of a cone as Bullet collides it: 48 at each end, smaller by the margin. O: as the shape's.
std::vector<Eigen::Vector3d> cone_corners(const model::Shape& cone);

/// Bullet's shape of a solid about O; without the thick margin that Bullet likes.
std::unique_ptr<btCollisionShape> make_shape(const model::Shape& shape);

/// The same of a convex solid with these corners.
std::unique_ptr<btCollisionShape> make_shape(const std::vector<Eigen::Vector3d>& corners);

/// Gives the collider a surface, whose address must stay. Friction between two colliders is that of
/// their two surfaces.
void make_touchable(btCollisionObject& collider, Surface& surface);

const Surface& surface_of(const btCollisionObject* collider);

}  // namespace prehend::grasping
