#include "common/analysis/contact_wrenches.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace prehend::analysis {
namespace {

using Eigen::Matrix4Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Unit, perpendicular to the unit vector n: the contact's tangent, or any when it has none.
Vector3d first_tangent(const Contact& contact, const Vector3d& n) {
  const Vector3d given = contact.tangent_O - contact.tangent_O.dot(n) * n;
  if (given.norm() > 1e-9) return given.normalized();
  Eigen::Index smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  return n.cross(Vector3d::Unit(smallest)).normalized();
}

}  // namespace

Matrix4Xd friction_edges(const Contact& contact, int edges) {
  const Vector3d n = contact.normal_O.normalized();
  const Vector3d t1 = first_tangent(contact, n), t2 = n.cross(t1);
  const bool soft = contact.torsion > 0;
  if (contact.friction == 0) {
    Matrix4Xd made(4, soft ? 2 : 1);
    made.topRows<3>().colwise() = n;
    made(3, 0) = contact.torsion;
    if (soft) made(3, 1) = -contact.torsion;
    return made;
  }
  Matrix4Xd made(4, soft ? 3 * edges + 2 : edges);
  Eigen::Index column = 0;
  const auto ring = [&](double radius, double moment) {
    for (int k = 0; k < edges; ++k) {
      const double angle = 2 * std::numbers::pi * k / edges;
      made.col(column++) << n + radius * (std::cos(angle) * t1 + std::sin(angle) * t2), moment;
    }
  };
  ring(contact.friction, 0);
  if (!soft) return made;
  const double half = 1 / std::numbers::sqrt2;  // sine and cosine of 45°
  for (const int side : {1, -1}) {
    ring(half * contact.friction, side * half * contact.torsion);
    made.col(column++) << n, side * contact.torsion;
  }
  return made;
}

Eigen::Matrix<double, 6, 4> contact_map(const Contact& contact, double torque_scale) {
  Eigen::Matrix<double, 6, 4> map = Eigen::Matrix<double, 6, 4>::Zero();
  map.topLeftCorner<3, 3>().setIdentity();
  for (int axis = 0; axis < 3; ++axis)
    map.block<3, 1>(3, axis) = contact.p_OC.cross(Vector3d::Unit(axis)) / torque_scale;
  map.block<3, 1>(3, 3) = contact.normal_O.normalized() / torque_scale;
  return map;
}

MatrixXd edge_wrenches(const Contact& contact, double torque_scale, int edges) {
  return contact_map(contact, torque_scale) * friction_edges(contact, edges);
}

MatrixXd contact_wrenches(const std::vector<Contact>& contacts, double torque_scale, int edges) {
  MatrixXd wrenches(6, 0);
  for (const Contact& contact : contacts) {
    const MatrixXd more = edge_wrenches(contact, torque_scale, edges);
    wrenches.conservativeResize(Eigen::NoChange, wrenches.cols() + more.cols());
    wrenches.rightCols(more.cols()) = more;
  }
  return wrenches;
}

}  // namespace prehend::analysis
