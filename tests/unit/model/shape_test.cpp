// The signed distance of each primitive against its definition: the distance to the nearest point
// of the surface, found by brute force over a dense sample of the surface.
#include "common/model/shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> sample_surface(const Shape& shape, Random& random, int count) {
  std::vector<Vector3d> points;
  const Vector3d half = half_extents(shape);
  for (int i = 0; i < count; ++i) {
    if (shape.kind == ShapeKind::sphere) {
      points.push_back(random.normal3(1).normalized() * shape.size.x());
    } else if (shape.kind == ShapeKind::box) {
      Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      p[static_cast<int>(random.index(3))] = random.uniform() < 0.5 ? -1 : 1;
      points.push_back(p.cwiseProduct(half));
    } else {
      const double angle = random.uniform(0, 2 * std::numbers::pi);
      const bool side = random.uniform() < 0.6;
      const double share = side ? 1 : std::sqrt(random.uniform());
      const double z =
          half.z() * (side ? random.uniform(-1, 1) : (random.uniform() < 0.5 ? -1 : 1));
      const double radius = share * radius_at(shape, z);
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  return points;
}

const Shape shapes[] = {{ShapeKind::cylinder, {0.03, 0.03, 0.1}},
                        {ShapeKind::box, {0.04, 0.2, 0.12}},
                        {ShapeKind::sphere, {0.04, 0.04, 0.04}},
                        {ShapeKind::cone, {0.025, 0.04, 0.1}},
                        {ShapeKind::cone, {0.05, 0, 0.08}}};

TEST(Shape, ReachesAsFarAsTheFarthestPointOfItsSurface) {
  Random random(8);
  for (const Shape& shape : shapes) {
    const auto surface = sample_surface(shape, random, 60000);
    for (int i = 0; i < 60; ++i) {
      const Vector3d direction = random.normal3(1).normalized();
      double farthest = -1;
      for (const Vector3d& p : surface) farthest = std::max(farthest, p.dot(direction));
      EXPECT_GE(extent(shape, direction), farthest - 1e-9) << to_string(shape.kind);
      EXPECT_NEAR(extent(shape, direction), farthest, 2e-3) << to_string(shape.kind);
    }
  }
}

TEST(Shape, SignedDistanceIsTheDistanceToTheSurface) {
  Random random(7);
  for (const Shape& shape : shapes) {
    const auto surface = sample_surface(shape, random, 60000);
    for (int i = 0; i < 60; ++i) {
      const Vector3d p = random.normal3(0.06);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vector3d& q : surface) nearest = std::min(nearest, (p - q).norm());
      // The sampled surface has gaps of about 1 mm, so the sampled distance is up to that too long.
      EXPECT_NEAR(std::abs(signed_distance(shape, p)), nearest, 2e-3) << to_string(shape.kind);
      const Vector3d half = half_extents(shape);
      if ((p.cwiseAbs() - half).maxCoeff() > 0) {
        EXPECT_GT(signed_distance(shape, p), 0);
      }
    }
    EXPECT_LT(signed_distance(shape, Vector3d::Zero()), 0);
  }
}

TEST(Shape, NamesRoundTripAndBadSizesAreInvalid) {
  for (const ShapeKind kind : {ShapeKind::unknown, ShapeKind::cylinder, ShapeKind::box,
                               ShapeKind::sphere, ShapeKind::cone})
    EXPECT_EQ(shape_from_string(to_string(kind)), kind);
  EXPECT_FALSE(shape_from_string("Cylinder").has_value());
  EXPECT_FALSE(is_valid({ShapeKind::box, {0.1, 0, 0.1}}));
  EXPECT_FALSE(is_valid({ShapeKind::box, {0.1, std::nan(""), 0.1}}));
  EXPECT_FALSE(is_valid({ShapeKind::unknown, {1, 1, 1}}));
  EXPECT_TRUE(is_valid({ShapeKind::cone, {0, 0.1, 0.1}}));
  EXPECT_FALSE(is_valid({ShapeKind::cone, {0, 0, 0.1}}));
  EXPECT_FALSE(is_valid({ShapeKind::cone, {-0.1, 0.1, 0.1}}));
  EXPECT_FALSE(is_valid({ShapeKind::cylinder, {0, 0.1, 0.1}}));
}

TEST(Shape, VolumeAndCentreOfAConeAreThoseOfPointsDrawnInIt) {
  Random random(11);
  for (const Shape& cone :
       {Shape{ShapeKind::cone, {0.02, 0.05, 0.09}}, Shape{ShapeKind::cone, {0.06, 0, 0.1}},
        Shape{ShapeKind::cone, {0.03, 0.03, 0.1}}}) {
    const Vector3d half = half_extents(cone);
    constexpr int drawn = 200000;
    Vector3d sum = Vector3d::Zero();
    int inside = 0;
    for (int i = 0; i < drawn; ++i) {
      const Vector3d p = half.cwiseProduct(
          Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
      if (signed_distance(cone, p) > 0) continue;
      sum += p;
      ++inside;
    }
    const double box = 8 * half.prod();
    EXPECT_NEAR(volume(cone) / (box * inside / drawn), 1, 0.02);
    EXPECT_LT((centre_of_mass(cone) - sum / inside).norm(), 5e-4);
  }
  const Shape same{ShapeKind::cone, {0.03, 0.03, 0.1}}, can{ShapeKind::cylinder, {0.03, 0.03, 0.1}};
  EXPECT_NEAR(volume(same), volume(can), 1e-12);
  EXPECT_EQ(like_known(same), can);
}

}  // namespace
}  // namespace prehend::model
