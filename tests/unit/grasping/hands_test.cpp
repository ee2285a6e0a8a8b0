// What every hand in common/models/hands must keep to in the world: the same calls give the same
// bits, a clone starts from the same bits, and nonsense is refused without a trace.
#include "tests/support/hands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "common/grasping/world.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// All that can be seen of a world, as one row of numbers.
VectorXd state_of(const World& world) {
  const HandMotion hand = world.hand_motion();
  const Pose X_WO = world.body_motion(0).X_WO;
  VectorXd all(hand.joint.size() * 3 + 24);
  all << hand.joint, hand.velocity, hand.torque,
      Eigen::Map<const VectorXd>(hand.X_WB.matrix().topRows<3>().eval().data(), 12),
      Eigen::Map<const VectorXd>(X_WO.matrix().topRows<3>().eval().data(), 12);
  return all;
}

class Hands : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand = test::hand(GetParam());

  /// The hand about a ball at its grasp frame, closing on it for `steps`.
  std::unique_ptr<World> closing(int steps) const {
    auto world = std::move(*World::create(hand, make_pose(Vector3d(0, 0, 0.5)),
                                          hand.postures().at("open"), {.table = false}));
    const Body ball{"ball", {model::ShapeKind::sphere, Vector3d::Constant(0.02)}, 0.1, "wood", {}};
    if (!world->add_body(ball, make_pose(world->hand_motion().X_WB * hand.X_BG().translation())))
      throw std::runtime_error("no ball");
    world->set_gravity(Vector3d::Zero());
    VectorXd closed = hand.postures().at("open");
    for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
      const model::HandDof& dof = hand.dofs()[i];
      if (dof.closing != 0)
        closed[static_cast<Eigen::Index>(i)] = dof.closing > 0 ? dof.upper : dof.lower;
    }
    if (!world->command(world->commanded_base(), closed)) throw std::runtime_error("refused");
    for (int i = 0; i < steps; ++i) world->step();
    return world;
  }
};

TEST_P(Hands, SameCallsGiveSameBits) {
  const auto a = closing(600), b = closing(600);
  EXPECT_EQ(state_of(*a), state_of(*b));
  EXPECT_TRUE(state_of(*a).allFinite());
}

// Guards against sliding fingers that turned: the world had made every joint a revolute one.
TEST_P(Hands, ShapesAreWhereTheJointsPutThem) {
  const Body ball{"ball", {model::ShapeKind::sphere, Vector3d::Constant(1e-4)}, 0, "wood", {}};
  for (const double share : {0.0, 0.3, 1.0}) {
    VectorXd dof(static_cast<Eigen::Index>(hand.dofs().size()));
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
      dof[i] = limits.lower + share * (limits.upper - limits.lower);
    }
    auto world = World::create(hand, make_pose(Vector3d(0, 0, 1)), dof);
    ASSERT_TRUE(world);
    ASSERT_TRUE((*world)->add_body(ball, Pose::Identity()));
    const std::vector<Pose> X_BL = hand.link_poses(hand.joint_angles(dof));
    for (std::size_t i = 0; i < X_BL.size(); ++i)
      for (const model::CollisionShape& part : hand.links()[i].collision) {
        (*world)->move_body(0, make_pose(Vector3d(0, 0, 1)) * X_BL[i] * part.X_LS);
        EXPECT_LT((*world)->distance_to_hand(0), 0) << hand.links()[i].name;
      }
  }
}

TEST_P(Hands, ACloneStartsFromTheSameBitsAndClonesStayTheSame) {
  const auto world = closing(400);
  const auto a = world->clone(), b = world->clone();
  EXPECT_EQ(state_of(*a), state_of(*world));
  const auto of_clone = a->clone();
  EXPECT_EQ(state_of(*of_clone), state_of(*world));
  for (int i = 0; i < 200; ++i)
    for (World* copy : {a.get(), b.get(), of_clone.get()}) copy->step();
  EXPECT_EQ(state_of(*a), state_of(*b));
  EXPECT_EQ(state_of(*a), state_of(*of_clone));
}

TEST_P(Hands, RefusedCommandsLeaveTheWorldAsItWas) {
  const auto told = closing(100), untold = closing(100);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const VectorXd good = told->commanded_dof();
  const Pose X_WB = told->commanded_base();
  EXPECT_FALSE(told->command(X_WB, VectorXd()));
  EXPECT_FALSE(told->command(X_WB, VectorXd::Zero(good.size() + 1)));
  EXPECT_FALSE(told->command(make_pose(Vector3d(infinity, 0, 0)), good));
  EXPECT_FALSE(told->command(X_WB, good, Vector3d(nan, 0, 0)));
  EXPECT_FALSE(told->place_hand(X_WB, VectorXd::Constant(good.size(), nan)));
  for (Eigen::Index i = 0; i < good.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    for (const double value : {nan, -infinity, dof.upper + 1.0, dof.lower - 1.0}) {
      VectorXd bad = good;
      bad[i] = value;
      const auto answer = told->command(X_WB, bad);
      ASSERT_FALSE(answer);
      EXPECT_FALSE(answer.error().what.empty());
    }
    VectorXd rounded = good;
    rounded[i] = dof.upper + 1e-9;
    EXPECT_TRUE(told->clone()->command(X_WB, rounded));
  }
  for (int i = 0; i < 100; ++i) {
    told->step();
    untold->step();
  }
  EXPECT_EQ(state_of(*told), state_of(*untold));
}

INSTANTIATE_TEST_SUITE_P(All, Hands, testing::ValuesIn(test::hand_names()));

}  // namespace
