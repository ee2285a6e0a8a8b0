// Joints that gears couple keep together whatever pushes, and a hand that is driven so comes to
// rest as one whose joints have drives of their own does. Every hand that comes with us is coupled
// in each way.
#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "common/grasping/world.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;
using prehend::test::coupled_hand;

/// How far a joint is from where what it is geared to would have it, rad or m.
double slack(const model::HandModel& hand, const VectorXd& joint) {
  double most = 0;
  for (std::size_t i = 0; i < hand.joints().size(); ++i) {
    const model::HandJoint& one = hand.joints()[i];
    if (one.geared_to < 0) continue;
    const auto to = static_cast<std::size_t>(one.geared_to);
    const double ratio = one.multiplier / hand.joints()[to].multiplier;
    const double due = one.offset + ratio * (joint[one.geared_to] - hand.joints()[to].offset);
    most = std::max(most, std::abs(joint[static_cast<Eigen::Index>(i)] - due));
  }
  return most;
}

class Geared : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

// A ball in the way of whatever closes; the hand grips it as hard as it can. How often the solver
// goes over its contacts does not matter to gears.
TEST_P(Geared, KeepTogetherWhateverPushes) {
  const auto& [name, coupling] = GetParam();
  const model::HandModel hand = coupled_hand(name, coupling);
  auto world =
      std::move(*World::create(hand, make_pose(Vector3d(0, 0, 1)), hand.postures().at("open"),
                               {.iterations = 4, .table = false}));
  const Body ball{"ball", {model::ShapeKind::sphere, Vector3d::Constant(0.025)}, 0, "metal", {}};
  ASSERT_TRUE(world->add_body(ball, world->base() * hand.X_BG()));
  VectorXd closed = hand.postures().at("open");
  for (Eigen::Index i = 0; i < closed.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    if (dof.closing == 0) continue;
    closed[i] += 0.9 * ((dof.closing > 0 ? dof.upper : dof.lower) - closed[i]);
  }
  ASSERT_TRUE(world->command(world->commanded_base(), closed));
  double most = 0;
  for (double t = 0; t < 1.5; t += world->time_step()) {
    world->step();
    most = std::max(most, slack(hand, world->hand_motion().joint));
  }
  EXPECT_LT(most, 0.02);
  EXPECT_LT(slack(hand, world->hand_motion().joint), 0.01);
  EXPECT_GE(world->contacts(0).size(), 1u);
}

// What a clone does is what the original would have done, of gears as of drives.
TEST_P(Geared, TwoClonesStayTheSame) {
  const auto& [name, coupling] = GetParam();
  const model::HandModel hand = coupled_hand(name, coupling);
  auto world = std::move(*World::create(hand, make_pose(Vector3d(0, 0, 1)),
                                        hand.postures().at("open"), {.table = false}));
  VectorXd some = hand.postures().at("open");
  Random random(7);
  for (Eigen::Index i = 0; i < some.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    some[i] = random.uniform(dof.lower, dof.upper);
  }
  ASSERT_TRUE(world->command(world->commanded_base(), some));
  for (int i = 0; i < 100; ++i) world->step();
  const auto one = world->clone(), other = world->clone();
  for (int i = 0; i < 100; ++i) {
    one->step();
    other->step();
  }
  EXPECT_EQ(one->hand_motion().joint, other->hand_motion().joint);
}

INSTANTIATE_TEST_SUITE_P(All, Geared,
                         testing::Combine(testing::Values("dlr", "robonaut", "parallel_jaw"),
                                          testing::Values("fingers", "rigid")));

TEST(Coupling, SaysWhatMovesEachJoint) {
  const auto geared = [](const model::HandModel& hand) {
    std::vector<std::string> pairs;
    for (const model::HandJoint& joint : hand.joints())
      if (joint.geared_to >= 0)
        pairs.push_back(joint.name + " to " +
                        hand.joints()[static_cast<std::size_t>(joint.geared_to)].name);
    return pairs;
  };
  EXPECT_TRUE(geared(test::hand("dlr")).empty());
  EXPECT_EQ(geared(coupled_hand("dlr", "fingers")).size(), 4u);
  // Each jaw is a finger; only what is rigid couples one to the other.
  EXPECT_TRUE(geared(coupled_hand("parallel_jaw", "fingers")).empty());
  EXPECT_EQ(geared(coupled_hand("parallel_jaw", "rigid")).size(), 1u);
}

}  // namespace
