// The long form of the hold test tells apart what the short one cannot: a grip that carries the
// object's weight but not twice that, and a hand that merely lies under its object.
#include "common/grasping/hold_test.hpp"

#include <gtest/gtest.h>

#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;

const model::HandModel& barrett() {
  return test::hand("barrett");
}

Body cylinder(double radius, double height, double mass) {
  return {"cylinder", {model::ShapeKind::cylinder, {radius, radius, height}}, mass, "plastic", {}};
}

/// A cylinder that stands on the table, gripped from the side.
std::unique_ptr<World> gripped(const Body& body) {
  const Eigen::Matrix3d R = model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  const Pose X_WB = make_pose(Vector3d(0, 0, 0.06), R) * barrett().X_BG().inverse();
  auto world = std::move(*World::create(barrett(), X_WB, VectorXd::Zero(4)));
  const double half = model::half_extents(body.shape).z();
  if (!world->add_body(body, make_pose(Vector3d(0, 0, half)))) throw std::runtime_error("body");
  VectorXd closed(4);
  closed << 0, 1.4, 1.4, 1.4;
  world->command(X_WB, closed);
  for (int i = 0; i < 750; ++i) world->step();
  return world;
}

TEST(LongHoldTest, AFirmGripSurvivesEveryPhase) {
  const auto world = gripped(cylinder(0.015, 0.145, 0.10));
  const HoldResult result = hold_test(*world->clone(), 0, HoldOptions::long_form());
  EXPECT_TRUE(result.held) << result.reason;
  EXPECT_EQ(result.lift, true);
  EXPECT_EQ(result.shake, true);
  EXPECT_EQ(result.turned_over, true);
  EXPECT_LT(result.drift, 1e-3);  // m/s; what hangs still does not creep
  EXPECT_GT(result.slip, 0);
}

TEST(LongHoldTest, TheShortFormLeavesThePhasesOut) {
  const auto world = gripped(cylinder(0.015, 0.145, 0.10));
  const HoldResult brief = hold_test(*world->clone(), 0);
  EXPECT_TRUE(brief.held);
  EXPECT_EQ(brief.lift, true);
  EXPECT_FALSE(brief.shake);
  EXPECT_FALSE(brief.turned_over);
}

TEST(LongHoldTest, WhatIsHeldLooselyIsShakenOut) {
  Body slippery = cylinder(0.024, 0.145, 0.15);
  slippery.friction = 0.26;
  const auto world = gripped(slippery);
  ASSERT_TRUE(hold_test(*world->clone(), 0).held);
  const HoldResult result = hold_test(*world->clone(), 0, {.shake = true});
  EXPECT_FALSE(result.held);
  EXPECT_EQ(result.lift, true);
  EXPECT_EQ(result.shake, false);
  EXPECT_FALSE(result.turned_over);
  EXPECT_FALSE(result.reason.empty());
}

TEST(LongHoldTest, WhatOnlyLiesOnTheHandFallsWhenItIsTurnedOver) {
  // The palm looks up and carries a block; the fingers are open.
  auto world =
      std::move(*World::create(barrett(), make_pose(Vector3d(0, 0, 0.2)), VectorXd::Zero(4)));
  const Body block{"block", {model::ShapeKind::box, {0.04, 0.03, 0.02}}, 0.05, "wood", {}};
  ASSERT_TRUE(world->add_body(block, make_pose(Vector3d(0, 0, 0.2 + 0.012 + 0.011))));
  for (int i = 0; i < 250; ++i) world->step();
  const HoldResult result = hold_test(*world->clone(), 0, {.turn_over = true});
  EXPECT_FALSE(result.held);
  EXPECT_EQ(result.lift, true);
  EXPECT_EQ(result.turned_over, false);
}

TEST(LongHoldTest, WhatCarriesSomethingElseIsNotHeldAlone) {
  const auto world = gripped(cylinder(0.015, 0.145, 0.10));
  const Body die{"die", {model::ShapeKind::box, {0.02, 0.02, 0.02}}, 0.01, "wood", {}};
  ASSERT_TRUE(world->add_body(die, make_pose(Vector3d(0, 0, 0.145 + 0.011))));
  const HoldResult result = hold_test(*world->clone(), 0);
  EXPECT_FALSE(result.held);
  EXPECT_EQ(result.reason, "touches something else");
}

TEST(LongHoldTest, SameBitsEveryTime) {
  const auto world = gripped(cylinder(0.015, 0.145, 0.10));
  const HoldResult a = hold_test(*world->clone(), 0, HoldOptions::long_form());
  const HoldResult b = hold_test(*world->clone(), 0, HoldOptions::long_form());
  EXPECT_EQ(a.slip, b.slip);
  EXPECT_EQ(a.turn, b.turn);
  EXPECT_EQ(a.drift, b.drift);
}

}  // namespace
