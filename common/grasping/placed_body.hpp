#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "common/grasping/bullet.hpp"
#include "common/grasping/world.hpp"

namespace prehend::grasping {

/// Fails on what cannot be simulated: invalid shapes, negative masses. Of the material says
/// nothing.
Expected<void> check_body(const Body& body, const Pose& X_WO);

/// A body as Bullet has it, at rest at first; who makes it adds `rigid` to a world.
struct PlacedBody {
  Body body;
  Pose X_OC = Pose::Identity();  // C: principal axes of inertia, which Bullet wants
  std::vector<std::unique_ptr<btCollisionShape>> shapes;  // the last one is the whole
  std::unique_ptr<btRigidBody> rigid;

  /// The body has passed check_body().
  PlacedBody(const Body& placed, const Pose& X_WO);
  /// Puts it there, at rest.
  void move_to(const Pose& X_WO);
  BodyMotion motion() const;

 private:
  btVector3 build_shapes();
};

}  // namespace prehend::grasping
