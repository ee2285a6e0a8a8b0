// Several hands in one world: each is led by itself, they are in each other's way, and two lift
// what is too wide for one without pressing each other through it.
#include <gtest/gtest.h>

#include "common/grasping/hold_test.hpp"
#include "common/grasping/world.hpp"
#include "tests/support/hands.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Push gentle{80, 20};
const WorldOptions pushed{.base = {.mass = 10, .inertia = 0.2}, .push = gentle};
const Body chest{"Chest", {model::ShapeKind::box, {0.30, 0.40, 0.40}}, 1.0, "wood", {}};
constexpr double height = 0.2;  // m, of the hands' bases

const model::HandModel& barrett() {
  return test::hand("barrett");
}

VectorXd open(const model::HandModel& hand) {
  return hand.postures().at("open");
}

/// A base at x that looks along x of W (side 1) or against it (side -1), the fingers upright.
Pose facing(double x, int side) {
  Eigen::Matrix3d R_WB;
  R_WB << Vector3d::UnitY() * side, Vector3d::UnitZ(), Vector3d::UnitX() * side;
  return make_pose(Vector3d(x, 0, height), R_WB);
}

std::unique_ptr<World> world_of(const model::HandModel& first, const model::HandModel& second,
                                double apart, const WorldOptions& options) {
  auto world =
      std::move(World::create(first, facing(-0.5 * apart, 1), open(first), options).value());
  EXPECT_EQ(world->add_hand(second, facing(0.5 * apart, -1), open(second)).value(), 1);
  return world;
}

void command(World& world, int hand, const Pose& X_WB, const VectorXd& dof) {
  ASSERT_TRUE(world.command(X_WB, dof, Vector3d::Zero(), hand));
}

void run(World& world, double time) {
  for (double t = 0; t < time; t += world.time_step()) world.step();
}

/// Two hands that press on the sides of the chest, or the first of them alone.
std::unique_ptr<World> pressing(int hands) {
  const double away = 0.5 * chest.shape.size.x() + 0.08, inside = away - 0.06;
  auto world =
      std::move(World::create(barrett(), facing(-away, 1), open(barrett()), pushed).value());
  if (hands == 2) {
    EXPECT_EQ(world->add_hand(barrett(), facing(away, -1), open(barrett())).value(), 1);
  }
  EXPECT_TRUE(world->add_body(chest, make_pose(Vector3d(0, 0, 0.5 * chest.shape.size.z()))));
  for (int hand = 0; hand < hands; ++hand)
    command(*world, hand, facing(hand == 0 ? -inside : inside, hand == 0 ? 1 : -1),
            open(barrett()));
  run(*world, 1);
  return world;
}

void expect_same(const World& one, const World& other, int hand) {
  const HandMotion a = one.hand_motion(hand), b = other.hand_motion(hand);
  EXPECT_EQ(a.X_WB.matrix(), b.X_WB.matrix());
  EXPECT_EQ(a.joint, b.joint);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.torque, b.torque);
}

TEST(TwoHands, EachFollowsItsOwnCommand) {
  const model::HandModel& jaw = test::hand("parallel_jaw");
  for (const WorldOptions& options : {WorldOptions{}, pushed}) {
    auto world = world_of(barrett(), jaw, 1.0, options);
    EXPECT_EQ(world->hand_count(), 2);
    EXPECT_EQ(world->hand(1).name(), "parallel_jaw");
    const VectorXd closed = VectorXd::Constant(4, 1.0), narrow = 0.5 * open(jaw);
    command(*world, 0, facing(-0.7, 1), closed);
    command(*world, 1, facing(0.6, -1), narrow);
    run(*world, 1.5);
    EXPECT_LT((world->base(0).translation() - facing(-0.7, 1).translation()).norm(), 1e-3);
    EXPECT_LT((world->base(1).translation() - facing(0.6, -1).translation()).norm(), 1e-3);
    EXPECT_LT((world->hand_motion(0).dof - closed).norm(), 5e-3);
    EXPECT_LT((world->hand_motion(1).dof - narrow).norm(), 1e-3);
    world->hold_still(0);
    command(*world, 1, facing(0.8, -1), narrow);
    run(*world, 1.5);
    EXPECT_LT((world->base(0).translation() - facing(-0.7, 1).translation()).norm(), 1e-3);
    EXPECT_LT((world->base(1).translation() - facing(0.8, -1).translation()).norm(), 1e-3);
    EXPECT_FALSE(world->hand_touches_anything(0) || world->hand_touches_anything(1));
  }
}

TEST(TwoHands, AreInEachOthersWay) {
  auto world = world_of(barrett(), barrett(), 0.5, pushed);
  for (const int hand : {0, 1})
    command(*world, hand, facing(0, hand == 0 ? 1 : -1), open(barrett()));
  run(*world, 2);
  EXPECT_GT(world->base(1).translation().x() - world->base(0).translation().x(), 0.08);
  EXPECT_TRUE(world->hand_touches_anything(0) && world->hand_touches_anything(1));
  const auto touches = world->touches();
  Vector3d force_W[2] = {Vector3d::Zero(), Vector3d::Zero()};
  for (const Touch& touch : touches) {
    EXPECT_EQ(touch.body, -1);
    force_W[touch.hand] += touch.force_W;
  }
  // What the links weigh beside the base is pushed as well.
  EXPECT_NEAR(force_W[0].x(), -gentle.force, 0.2 * gentle.force);
  EXPECT_LT((force_W[0] + force_W[1]).norm(), 1e-6);
}

TEST(TwoHands, AnotherHandLeavesTheFirstAsItIs) {
  for (const WorldOptions& options : {WorldOptions{}, pushed}) {
    auto alone =
        std::move(World::create(barrett(), facing(-0.5, 1), open(barrett()), options).value());
    auto beside = world_of(barrett(), test::hand("dlr"), 1.0, options);
    for (World* world : {alone.get(), beside.get()})
      command(*world, 0, facing(-0.45, 1), VectorXd::Constant(4, 1.0));
    for (int i = 0; i < 100; ++i) {
      alone->step();
      beside->step();
      expect_same(*alone, *beside, 0);
    }
  }
}

TEST(TwoHands, ACloneIsInTheSameStateAndMovesAlike) {
  auto world = world_of(barrett(), test::hand("dlr"), 1.0, pushed);
  command(*world, 0, facing(-0.8, 1), VectorXd::Constant(4, 1.0));
  command(*world, 1, facing(0.7, -1), open(test::hand("dlr")));
  run(*world, 0.1);
  const auto copy = world->clone();
  ASSERT_EQ(copy->hand_count(), 2);
  for (int i = 0; i < 100; ++i) {
    for (const int hand : {0, 1}) expect_same(*world, *copy, hand);
    world->step();
    copy->step();
  }
  EXPECT_GT((world->base(1).translation() - facing(0.5, -1).translation()).norm(), 0.05);
}

TEST(TwoHands, ContactsAndTouchesNameTheHand) {
  const auto world = pressing(2);
  double force[2] = {0, 0};
  for (const analysis::Contact& contact : world->contacts(0)) {
    EXPECT_EQ(contact.hand, contact.p_OC.x() < 0 ? 0 : 1);
    force[contact.hand] += contact.force;
  }
  for (const double sum : force) {
    EXPECT_GT(sum, 0.3 * gentle.force);
    EXPECT_LT(sum, 1.5 * gentle.force);
  }
  const auto touches = world->touches();
  EXPECT_EQ(touches.size(), world->contacts(0).size());
  for (const Touch& touch : touches) EXPECT_EQ(touch.hand, touch.p_W.x() < 0 ? 0 : 1);
}

TEST(TwoHands, LiftWhatIsTooWideForOne) {
  const auto world = pressing(2);
  const HoldResult both = hold_test(*world->clone(), 0);
  EXPECT_TRUE(both.held) << both.reason << ", slip " << both.slip << " m, turn " << both.turn;
  EXPECT_FALSE(hold_test(*pressing(1), 0).held);
  // It goes on holding where it was told to stop.
  for (const int hand : {0, 1}) world->brake(hand);
  run(*world, 0.5);
  EXPECT_TRUE(hold_test(*world->clone(), 0).held);
}

TEST(TwoHands, RefuseNonsense) {
  auto world = world_of(barrett(), barrett(), 1.0, {});
  EXPECT_FALSE(world->add_hand(barrett(), Pose::Identity(), VectorXd::Zero(3)));
  EXPECT_EQ(world->hand_count(), 2);
  EXPECT_FALSE(world->command(Pose::Identity(), VectorXd::Zero(3), Vector3d::Zero(), 1));
}

}  // namespace
}  // namespace prehend::grasping
