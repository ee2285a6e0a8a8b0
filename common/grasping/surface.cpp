#include "common/grasping/surface.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <limits>

#include "common/grasping/bullet.hpp"

namespace prehend::grasping {
namespace {

constexpr double collision_margin = 0.0005;  // m; Bullet's default of 0.04 is far too much here
constexpr double rolling_friction = 0.0002;  // m; keeps a standing or lying cylinder where it is

double friction_between(const Surface& a, const Surface& b) {
  if (a.friction || b.friction)
    return std::min(a.friction.value_or(std::numeric_limits<double>::infinity()),
                    b.friction.value_or(std::numeric_limits<double>::infinity()));
  return analysis::friction(a.material, b.material);
}

/// Bullet multiplies two numbers for friction; the table knows pairs.
bool set_friction(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                  const btCollisionObjectWrapper* b, int, int) {
  const Surface& first = surface_of(a->getCollisionObject());
  const Surface& second = surface_of(b->getCollisionObject());
  point.m_combinedFriction = friction_between(first, second);
  const bool slippery = point.m_combinedFriction < 0.1;
  point.m_combinedSpinningFriction =
      slippery ? 0 : analysis::torsion(first.material, second.material);
  point.m_combinedRollingFriction = slippery ? 0 : rolling_friction;
  return true;
}

/// Bullet has one callback for the whole process. Set before the first contact, then never again.
void install_friction() {
  static const bool installed = (gContactAddedCallback = set_friction, true);
  static_cast<void>(installed);
}

}  // namespace

std::unique_ptr<btCollisionShape> make_shape(const model::Shape& shape) {
  std::unique_ptr<btCollisionShape> made;
  switch (shape.kind) {
    case model::ShapeKind::box:
      made = std::make_unique<btBoxShape>(to_bullet(Eigen::Vector3d(0.5 * shape.size)));
      break;
    case model::ShapeKind::cylinder:
      made = std::make_unique<btCylinderShapeZ>(
          btVector3(shape.size.x(), shape.size.x(), 0.5 * shape.size.z()));
      break;
    default:
      return std::make_unique<btSphereShape>(shape.size.x());
  }
  made->setMargin(collision_margin);
  return made;
}

std::unique_ptr<btCollisionShape> make_shape(const std::vector<Eigen::Vector3d>& corners) {
  auto made = std::make_unique<btConvexHullShape>();
  for (const Eigen::Vector3d& corner : corners) made->addPoint(to_bullet(corner), false);
  made->recalcLocalAabb();
  made->setMargin(collision_margin);
  return made;
}

void make_touchable(btCollisionObject& collider, Surface& surface) {
  install_friction();
  collider.setUserPointer(&surface);
  collider.setCollisionFlags(collider.getCollisionFlags() |
                             btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
  // Bullet skips rolling and spinning friction unless the objects ask for some.
  collider.setSpinningFriction(1.0);
  collider.setRollingFriction(rolling_friction);
  collider.setFriction(1.0);
  collider.setRestitution(0);
  collider.setActivationState(DISABLE_DEACTIVATION);
}

const Surface& surface_of(const btCollisionObject* collider) {
  return *static_cast<const Surface*>(collider->getUserPointer());
}

}  // namespace prehend::grasping
