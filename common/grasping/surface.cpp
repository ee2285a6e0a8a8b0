#include "common/grasping/surface.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/grasping/bullet.hpp"

namespace prehend::grasping {
namespace {

constexpr double rolling_friction = 0.0002;  // m; keeps a standing or lying cylinder where it is
/// Of the points where a roller touches, some are a step old and lie behind it: they push it on.
constexpr double trail = 0.0015;  // s; above half a step, so that it always loses

double friction_between(const Surface& a, const Surface& b) {
  if (a.friction || b.friction)
    return std::min(a.friction.value_or(std::numeric_limits<double>::infinity()),
                    b.friction.value_or(std::numeric_limits<double>::infinity()));
  return analysis::friction(a.material, b.material);
}

/// m/s, at which a body rolls over what stands; what only turns around the normal does not roll.
double roll(const btCollisionObject& body, const btCollisionObject& on, const btManifoldPoint& at) {
  if (!on.isStaticObject()) return 0;
  const btVector3 turn = body.getInterpolationAngularVelocity();
  const btVector3 arm = at.getPositionWorldOnB() - body.getWorldTransform().getOrigin();
  return (turn - at.m_normalWorldOnB * turn.dot(at.m_normalWorldOnB)).cross(arm).length();
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
  point.m_combinedRollingFriction =
      slippery
          ? 0
          : std::max(rolling_friction,
                     trail * (roll(*a->getCollisionObject(), *b->getCollisionObject(), point) +
                              roll(*b->getCollisionObject(), *a->getCollisionObject(), point)));
  return true;
}

/// Bullet has one callback for the whole process. Set before the first contact, then never again.
void install_friction() {
  static const bool installed = (gContactAddedCallback = set_friction, true);
  static_cast<void>(installed);
}

}  // namespace

std::vector<Eigen::Vector3d> cone_corners(const model::Shape& cone) {
  constexpr int corners = 48;
  // The wall moves inwards by the margin; where it would pass the axis, the cone ends there.
  // A quarter of its half extents at most: of what is tiny or flat something is left.
  const double margin = std::min(collision_margin, 0.25 * model::half_extents(cone).minCoeff());
  const double rise = model::slope(cone), inwards = margin * std::hypot(1, rise);
  const double half = 0.5 * cone.size.z() - margin;
  std::vector<Eigen::Vector3d> points;
  for (const double end : {-half, half}) {
    double z = end, radius = model::radius_at(cone, end) - inwards;
    if (radius < 0) z -= radius / rise, radius = 0;
    for (int i = 0; i < (radius > 0 ? corners : 1); ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  return points;
}

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
    case model::ShapeKind::cone:
      return make_shape(cone_corners(shape));
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
