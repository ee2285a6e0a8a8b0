// The slice of forces that a grasp resists, against grasps whose slice is known on paper.
#include "services/console/core/resisted_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace prehend::console {
namespace {

using analysis::Contact;
using Eigen::Vector3d;

Contact at(const Vector3d& place, const Vector3d& normal, double friction) {
  return {"link", place, normal, friction, 1, 0};
}

/// A contact in the middle of each side of a cube of 40 mm; friction bears every moment.
std::vector<Contact> all_around(double friction) {
  std::vector<Contact> contacts;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      contacts.push_back(
          at(0.02 * side * Vector3d::Unit(axis), -side * Vector3d::Unit(axis), friction));
  return contacts;
}

double farthest(const std::vector<Vector3d>& corners, const Vector3d& along) {
  double most = -1;
  for (const Vector3d& corner : corners) most = std::max(most, corner.dot(along));
  return most;
}

// A force along an axis is resisted by the one contact that faces it, which presses with all of the
// 1 N: friction beside it needs normal force, too, so it adds nothing.
TEST(ResistedForces, OfACubeHeldAllAroundReachOneNewtonAlongEachAxis) {
  const auto corners = resisted_forces(all_around(0.5));
  ASSERT_FALSE(corners.empty());
  EXPECT_EQ(corners.size() % 3, 0U);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vector3d along = side * Vector3d::Unit(axis);
      double on_axis = 0;
      for (const Vector3d& corner : corners)
        if (corner.normalized().dot(along) > 1 - 1e-9) on_axis = corner.norm();
      EXPECT_NEAR(on_axis, 1, 1e-6) << axis << " " << side;
    }
  // No contact's force is longer than sqrt(1 + 0.5²) N, so no sum of them is.
  for (const Vector3d& corner : corners) EXPECT_LT(corner.norm(), std::sqrt(1.25) + 1e-9);
}

// Each side of a triangle is that of one other: no hole, and nothing twice.
TEST(ResistedForces, AreAClosedSurface) {
  const auto corners = resisted_forces(all_around(0.5));
  const auto number = [&](const Vector3d& corner) {
    return std::find_if(corners.begin(), corners.end(),
                        [&](const Vector3d& one) { return (one - corner).norm() < 1e-9; }) -
           corners.begin();
  };
  std::map<std::pair<std::ptrdiff_t, std::ptrdiff_t>, int> sides;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k)
      ++sides[std::minmax(number(corners[i + k]), number(corners[i + (k + 1) % 3]))];
  for (const auto& [side, count] : sides) EXPECT_EQ(count, 2) << side.first << ' ' << side.second;
}

// Who only pushes cannot pull.
TEST(ResistedForces, OfContactsOnOneSideAreNone) {
  const Vector3d normal = Vector3d::UnitX();
  EXPECT_TRUE(
      resisted_forces({at({-0.02, 0.02, 0}, normal, 0.5), at({-0.02, -0.02, 0.01}, normal, 0.5),
                       at({-0.02, 0, -0.02}, normal, 0.5)})
          .empty());
  EXPECT_TRUE(resisted_forces({}).empty());
}

// Less friction, less force.
TEST(ResistedForces, GrowWithFriction) {
  const Vector3d slanted = Vector3d(1, 1, 0).normalized();
  EXPECT_LT(farthest(resisted_forces(all_around(0.2)), slanted) + 1e-3,
            farthest(resisted_forces(all_around(0.8)), slanted));
}

TEST(ResistedForces, AreCountedFromOutside) {
  const auto corners = resisted_forces(all_around(0.5));
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const Vector3d normal = (corners[i + 1] - corners[i]).cross(corners[i + 2] - corners[i]);
    EXPECT_GE(normal.dot(corners[i] + corners[i + 1] + corners[i + 2]), -1e-12);
  }
}

}  // namespace
}  // namespace prehend::console
