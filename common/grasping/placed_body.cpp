#include "common/grasping/placed_body.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "common/grasping/mesh_body.hpp"
#include "common/grasping/surface.hpp"

namespace prehend::grasping {

Expected<void> check_body(const Body& body, const Pose& X_WO) {
  if (!model::is_valid(body.shape)) return fail("shape is not valid", body.name);
  if (body.mesh && (body.mesh->parts.parts.empty() || !body.mesh->inertia_C.allFinite()))
    return fail("mesh is not valid", body.name, "see solid_of");
  if (!std::isfinite(body.mass) || body.mass < 0) return fail("mass must be 0 or more", body.name);
  if (!is_finite(X_WO)) return fail("pose must be finite", body.name);
  if (body.friction && !(*body.friction >= 0 && std::isfinite(*body.friction)))
    return fail("friction must be 0 or more", body.name);
  return {};
}

PlacedBody::PlacedBody(const Body& placed, const Pose& X_WO) : body(placed) {
  const btVector3 inertia = build_shapes();
  btRigidBody::btRigidBodyConstructionInfo info(body.mass, nullptr, shapes.back().get(), inertia);
  info.m_startWorldTransform = to_bullet(X_WO * X_OC);
  info.m_linearDamping = info.m_angularDamping = 0;
  rigid = std::make_unique<btRigidBody>(info);
}

// Makes the shapes and the frame C, and returns the moments of inertia there.
btVector3 PlacedBody::build_shapes() {
  const double mass = body.mass;
  btVector3 inertia(0, 0, 0);
  if (!body.mesh && body.shape.kind == model::ShapeKind::cone) body.mesh = cone_mesh(body.shape);
  if (!body.mesh) {
    shapes.push_back(make_shape(body.shape));
    if (mass > 0) shapes.back()->calculateLocalInertia(mass, inertia);
    return inertia;
  }
  const SolidMesh& mesh = *body.mesh;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(mesh.inertia_C);
  Eigen::Matrix3d R_OC = principal.eigenvectors();
  if (R_OC.determinant() < 0) R_OC.col(0) *= -1;
  X_OC = make_pose(mesh.p_OC, R_OC);
  auto compound = std::make_unique<btCompoundShape>();
  for (const auto& corners : mesh.parts.parts) {
    shapes.push_back(make_shape(corners));
    compound->addChildShape(to_bullet(X_OC.inverse()), shapes.back().get());
  }
  shapes.push_back(std::move(compound));
  if (mass > 0) inertia = to_bullet(Eigen::Vector3d(mass * principal.eigenvalues()));
  return inertia;
}

void PlacedBody::move_to(const Pose& X_WO) {
  rigid->setWorldTransform(to_bullet(X_WO * X_OC));
  rigid->setInterpolationWorldTransform(rigid->getWorldTransform());
  rigid->setLinearVelocity(btVector3(0, 0, 0));
  rigid->setAngularVelocity(btVector3(0, 0, 0));
  rigid->clearForces();
}

BodyMotion PlacedBody::motion() const {
  const Pose X_WO = from_bullet(rigid->getWorldTransform()) * X_OC.inverse();
  const Eigen::Vector3d turning = from_bullet(rigid->getAngularVelocity());
  const Eigen::Vector3d p_CO_W = -(X_WO.linear() * X_OC.translation());
  return {X_WO, from_bullet(rigid->getLinearVelocity()) + turning.cross(p_CO_W), turning};
}

}  // namespace prehend::grasping
