#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/base/random.hpp"

namespace prehend::analysis {

/// `count` contacts anywhere on an ellipsoid of the size of a cup, normals inward.
inline std::vector<Contact> random_grasp(Random& random, int count) {
  const Eigen::Vector3d radii(0.03, 0.04, 0.06);
  std::vector<Contact> contacts;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d out = random.normal3(1).normalized();
    contacts.push_back({"finger", radii.cwiseProduct(out), -out.cwiseQuotient(radii).normalized(),
                        random.uniform(0.2, 1.2), 1, 0});
  }
  return contacts;
}

/// What hull algorithms find hardest, one kind after the other: points that lie in common planes.
/// Rings of equal contacts about a cylinder at one or two heights, opposite pairs, corners of a
/// box, the same contact twice, all with edges that run along the symmetry.
inline std::vector<Contact> symmetric_grasp(Random& random, int kind) {
  using Eigen::Vector3d;
  const double friction = 0.2 * static_cast<double>(1 + random.index(5));
  std::vector<Contact> contacts;
  const auto touch = [&](const Vector3d& p, const Vector3d& n) {
    Contact contact{"finger", p, n, friction, 1, 0};
    contact.tangent_O = Vector3d::UnitZ();
    if (n.cross(contact.tangent_O).norm() < 1e-9) contact.tangent_O = Vector3d::UnitX();
    contacts.push_back(contact);
  };
  const auto ring = [&](std::size_t count, double height) {
    for (std::size_t i = 0; i < count; ++i) {
      const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
      const Vector3d out(std::cos(a), std::sin(a), 0);
      touch(0.03 * out + Vector3d(0, 0, height), -out);
    }
  };
  switch (kind % 5) {
    case 0:
      ring(3 + random.index(6), 0);
      break;
    case 1: {
      const std::size_t count = 2 + random.index(3);
      ring(count, 0.02);
      ring(count, -0.02);
      break;
    }
    case 2:
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
          touch(0.03 * side * Vector3d::Unit(axis), -side * Vector3d::Unit(axis));
      break;
    case 3:
      for (int corner = 0; corner < 8; ++corner)
        touch({corner & 1 ? 0.02 : -0.02, corner & 2 ? 0.03 : -0.03, corner & 4 ? 0.04 : -0.04},
              {corner & 1 ? -1.0 : 1.0, 0, 0});
      break;
    default:
      ring(3 + random.index(2), 0.01);
      contacts.push_back(contacts.front());
      ring(3, -0.01);
  }
  return contacts;
}

}  // namespace prehend::analysis
