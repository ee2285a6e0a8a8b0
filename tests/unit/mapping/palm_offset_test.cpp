// Where a hand learnt to stand, for sizes that it knows and others: Shepard's interpolation with a
// softening of 5 mm. Sizes 3 cm apart then count (1 + 36)² ≈ 1400 to 1, so that a known size keeps
// its place within 0.1 mm.
#include "services/mapping/core/palm_offset.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/model/placement.hpp"
#include "services/mapping/core/size_input.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;
using model::ShapeKind;

model::Shape cylinder(double radius) {
  return {ShapeKind::cylinder, {radius, radius, 0.1}};
}

const Pose from_above =
    make_pose(Vector3d(0, 0, 0.02), model::grasp_axes(-Vector3d::UnitZ(), Vector3d::UnitY()));
const Pose from_the_side =
    make_pose(Vector3d::Zero(), model::grasp_axes(Vector3d::UnitX(), Vector3d::UnitY()));

PalmOffset learnt(const model::Shape& shape, const Pose& X_OG, const Vector3d& p_GR) {
  return {shape.kind, size_numbers(SizeInput::seen, shape, X_OG), p_GR};
}

const std::vector<PalmOffset> known{learnt(cylinder(0.015), from_above, {0, 0.01, 0}),
                                    learnt(cylinder(0.030), from_above, {0, -0.01, 0.005}),
                                    learnt(cylinder(0.015), from_the_side, {0, 0, 0.02})};

TEST(PalmOffset, OfAKnownSizeIsKept) {
  EXPECT_NEAR((place_for(known, cylinder(0.015), from_above) - known[0].p_GR).norm(), 0, 1e-4);
  EXPECT_NEAR((place_for(known, cylinder(0.030), from_above) - known[1].p_GR).norm(), 0, 1e-4);
  EXPECT_NEAR((place_for(known, cylinder(0.015), from_the_side) - known[2].p_GR).norm(), 0, 1e-4);
}

TEST(PalmOffset, GoesFromOneSizeToTheNextWithoutJumps) {
  double before = place_for(known, cylinder(0.015), from_above).y();
  for (double radius = 0.0155; radius <= 0.030; radius += 0.0005) {
    const double now = place_for(known, cylinder(radius), from_above).y();
    EXPECT_LE(now, before + 1e-9) << radius;
    EXPECT_LT(before - now, 0.004) << radius;
    before = now;
  }
}

TEST(PalmOffset, OfAnotherShapeIsTheOneAskedFor) {
  EXPECT_EQ(place_for(known, {ShapeKind::box, {0.03, 0.03, 0.1}}, from_above), Vector3d::Zero());
  EXPECT_EQ(place_for({}, cylinder(0.03), from_above), Vector3d::Zero());
}

TEST(PalmOffset, RefusesWhatCannotBe) {
  EXPECT_TRUE(check(known[0]));
  PalmOffset bad = known[0];
  bad.shape = ShapeKind::unknown;
  EXPECT_FALSE(check(bad));
  for (const double wrong :
       {0.2, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    bad = known[0];
    bad.p_GR.y() = wrong;
    EXPECT_FALSE(check(bad)) << wrong;
  }
  bad = known[0];
  bad.seen[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check(bad));
}

}  // namespace
}  // namespace prehend::mapping
