// A hand that an arm carries: it is where the arm is, weighs on it, and gives way to what it is
// pushed against.
#include "common/grasping/carrier.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/grasping/world.hpp"
#include "tests/support/hands.hpp"

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;

namespace {

constexpr Push strong{150, 20};
constexpr BaseBody light{10, 0.2};

/// The palm looks down.
Pose above(double height) {
  Pose X = make_pose(Vector3d(0, 0, height));
  X.rotate(Eigen::AngleAxisd(EIGEN_PI, Vector3d::UnitX()));
  return X;
}

std::unique_ptr<World> carried(const std::string& hand, const Pose& X_WB) {
  const model::HandModel& model = test::hand(hand);
  auto world = World::create(model, X_WB, model.postures().at("open"), {.base = light});
  if (!world) throw std::runtime_error(world.error().message());
  return std::move(*world);
}

TEST(Carrier, AFreeHandIsWhereItsArmIs) {
  for (const std::string& name : test::hand_names()) {
    const auto world = carried(name, above(0.6));
    double worst = 0;
    for (int k = 1; k <= 500; ++k) {
      const double t = k * world->time_step();
      Pose X = above(0.6 + 0.1 * std::sin(3 * t));
      X.pretranslate(Vector3d(0.2 * std::sin(2 * t), 0, 0));
      X.rotate(Eigen::AngleAxisd(0.5 * std::sin(2 * t), Vector3d(1, 2, 3).normalized()));
      world->carry(X, strong);
      world->step();
      worst = std::max({worst, (world->base().translation() - X.translation()).norm(),
                        angle_between(world->base().linear(), X.linear())});
    }
    EXPECT_LT(worst, 2e-4) << name;
  }
}

// What was pushed through the table by a hand that flies, a table pushes back.
TEST(Carrier, PressesOnTheTableNoHarderThanItsArmCan) {
  const auto world = carried("parallel_jaw", above(0.5));
  double pushed = 0, lowest = 1;
  for (int k = 1; k <= 1500; ++k) {
    world->carry(above(0.5 - 0.48 * std::min(1.0, k / 750.0)), strong);
    world->step();
    lowest = std::min(lowest, world->base().translation().z());
    if (k > 1400) pushed = std::max(pushed, world->base_load().force.z());
  }
  const double stays = world->base().translation().z();
  EXPECT_GT(stays, 0.06) << "it is where the arm is: nothing holds it";
  EXPECT_GT(pushed, 0.5 * strong.force);
  EXPECT_LT(pushed, 1.5 * strong.force);
  EXPECT_GT(lowest, stays - 0.01);
  // The arm goes away: so does the hand, and does not swing.
  double highest = 0;
  for (int k = 1; k <= 1000; ++k) {
    world->carry(above(std::min(0.4, 0.02 + k * 0.001)), strong);
    world->step();
    highest = std::max(highest, world->base().translation().z());
  }
  EXPECT_NEAR(world->base().translation().z(), 0.4, 1e-4);
  EXPECT_LT(highest, 0.4 + 2e-3);
}

TEST(Carrier, ACloneIsCarriedByNobodyAndGivesWayToNothing) {
  const auto world = carried("parallel_jaw", above(0.5));
  world->carry(above(0.5), strong);
  world->step();
  const auto clone = world->clone();
  EXPECT_EQ(clone->base_load().force.norm(), 0);
  const Eigen::VectorXd open = world->hand().postures().at("open");
  ASSERT_TRUE(clone->command(above(0.6), open));
  for (int k = 0; k < 500; ++k) clone->step();
  EXPECT_NEAR(clone->base().translation().z(), 0.6, 1e-3);
  EXPECT_NEAR(world->base().translation().z(), 0.5, 1e-5);
}

}  // namespace
