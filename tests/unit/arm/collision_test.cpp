// Distances between capsules against a search over both lines, and what an arm may touch.
#include "common/arm/collision.hpp"

#include <gtest/gtest.h>

#include "tests/support/arms/arms.hpp"

using namespace prehend;

namespace {

model::Capsule random_capsule(Random& random) {
  return {random.normal3(0.3), random.normal3(0.3), random.uniform(0, 0.1)};
}

TEST(Capsules, AreAsFarApartAsTheNearestPointsOfTheirLines) {
  Random random(1);
  for (int k = 0; k < 300; ++k) {
    model::Capsule a = random_capsule(random), b = random_capsule(random);
    if (k % 5 == 0) b.b = b.a;                       // a sphere
    if (k % 7 == 0) a.b = a.a;                       // two
    if (k % 11 == 0) b.b = b.a + 1.7 * (a.b - a.a);  // parallel
    const arm::Nearest found = arm::nearest(a, b);
    double least = 100;
    for (int i = 0; i <= 60; ++i)
      for (int j = 0; j <= 60; ++j)
        least =
            std::min(least, (a.a + i / 60.0 * (a.b - a.a) - b.a - j / 60.0 * (b.b - b.a)).norm());
    EXPECT_LE(found.distance, least - a.radius - b.radius + 1e-12);
    EXPECT_GT(found.distance, least - a.radius - b.radius - 0.04);  // steps of the grid
  }
}

TEST(Capsules, HoldTheShapesThatTheyAreMadeOf) {
  Random random(2);
  for (const model::ShapeKind kind :
       {model::ShapeKind::box, model::ShapeKind::cylinder, model::ShapeKind::sphere}) {
    model::CollisionShape shape{
        {kind, {0.05, 0.05, 0.2}},
        make_pose(Eigen::Vector3d(0.1, 0, 0), Eigen::Quaterniond(1, 2, 0, 1).normalized())};
    if (kind == model::ShapeKind::sphere) shape.shape.size.setConstant(0.05);
    const model::Capsule capsule = model::capsule_around(shape);
    for (int k = 0; k < 500; ++k) {
      const Eigen::Vector3d p_S = random.normal3(0.1);
      if (model::signed_distance(shape.shape, p_S) > 0) continue;
      const Eigen::Vector3d p = shape.X_LS * p_S;
      EXPECT_LE(arm::nearest(capsule, {p, p, 0}).distance, 1e-9);
    }
  }
}

TEST(Collision, HomesTouchNothing) {
  for (const std::string& name : test::arm_names()) {
    const model::ArmModel& model = test::arm(name);
    const arm::Collision collision(model, {0.0, {}});
    EXPECT_GT(collision.clearance(arm::forward(model, model.home), 0.1), 0) << name;
  }
}

TEST(Collision, AFoldedArmTouchesItselfAndALowOneTheTable) {
  const model::ArmModel& puma = test::arm("puma560");
  const arm::Collision collision(puma, {0.0, {}});
  arm::Joints folded = arm::Joints::Zero(6);
  folded[1] = -0.78;  // down, and back upon the column
  folded[2] = -3.9;
  arm::Joints low = arm::Joints::Zero(6);
  low[1] = -0.78;
  low[2] = -1.57;
  EXPECT_LT(collision.clearance(arm::forward(puma, low), 0.3), 0.3);
  const auto pairs = collision.near(arm::forward(puma, low), 0.3);
  EXPECT_TRUE(
      std::any_of(pairs.begin(), pairs.end(), [](const auto& p) { return p.second == -1; }));
  // What is carried counts: a hand of 30 cm reaches further than the wrist.
  const arm::Collision carrying(puma, {0.0, {{{0, 0, 0.05}, {0, 0, 0.3}, 0.05}}});
  EXPECT_LT(carrying.clearance(arm::forward(puma, low), 1),
            collision.clearance(arm::forward(puma, low), 1) - 0.1);
}

}  // namespace
