#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <algorithm>

namespace prehend::grasping {

/// Smallest distance that a test between two colliders finds, m; negative when they overlap.
struct ClosestDistance : btCollisionWorld::ContactResultCallback {
  double distance;

  explicit ClosestDistance(double most) : distance(most) { m_closestDistanceThreshold = most; }
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    distance = std::min(distance, point.getDistance());
    return 0;
  }
};

}  // namespace prehend::grasping
