// Two robot hands in one world. The judge is the distance of all capsules of one hand to all of the
// other, pair by pair; 0.2 mm are for steps of a command, which are straight between two looks.
#include "services/mapping/core/other_hands.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "services/mapping/core/mapping.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;

constexpr double margin = 0.005, rounding = 2e-4;  // m

double distance_between(const std::vector<Capsule>& ours, const std::vector<Capsule>& theirs) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& one : ours)
    for (const Capsule& other : theirs) least = std::min(least, distance(one, other));
  return least;
}

Vector3d middle_of(const std::vector<Capsule>& hand) {
  Vector3d sum = Vector3d::Zero();
  for (const Capsule& one : hand) sum += 0.5 * (one.a + one.b);
  return sum / static_cast<double>(hand.size());
}

Pose drawn_pose(Random& random, double width) {
  const auto in = [&](double most) { return random.uniform(-most, most); };
  return make_pose({in(width), in(width), in(width)},
                   Eigen::Quaterniond(in(1), in(1), in(1), in(1)).normalized());
}

class EveryPair : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  Eigen::VectorXd open_ = hand_.postures().at("open");
  HandCapsules ours_{hand_}, theirs_{barrett()};

  std::vector<Capsule> other_at(const Pose& X_WB) const {
    return theirs_.at(X_WB, barrett().postures().at("open"));
  }
};

TEST_P(EveryPair, ReachHoldsTheWholeHand) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    Eigen::VectorXd dof(open_.size());
    for (Eigen::Index k = 0; k < dof.size(); ++k) {
      const model::HandDof& it = hand_.dofs()[static_cast<std::size_t>(k)];
      dof[k] = random.uniform(it.lower, it.upper);
    }
    for (const Capsule& one : ours_.at(Pose::Identity(), dof))
      EXPECT_LT(std::max(one.a.norm(), one.b.norm()) + one.radius, ours_.reach() + 1e-9);
  }
}

TEST_P(EveryPair, ComeNoNearerThanTheMargin) {
  Random random(11);
  int met = 0;
  for (int round = 0; round < 40; ++round) {
    OtherHands others(hand_);
    const auto theirs = other_at(drawn_pose(random, 0.05));
    others.observe("other", theirs);
    Pose now = drawn_pose(random, 0.1);
    now.pretranslate((ours_.reach() + theirs_.reach() + 0.1) * Vector3d::UnitX());
    const Pose goal = drawn_pose(random, 0.3);
    for (int frame = 0; frame < 90; ++frame) {  // as MotionLimits lets a hand go in 1/30 s
      const Pose free = limit_step(now, goal, 0.033, 0.1);
      const Pose next = others.go(now, free, open_);
      const double distance = distance_between(ours_.at(next, open_), theirs);
      ASSERT_GT(distance, margin - rounding) << "round " << round << " frame " << frame;
      if (distance_between(ours_.at(free, open_), theirs) > 0.04) {
        EXPECT_TRUE(next.isApprox(free, 1e-12)) << "nothing is in the way";
      }
      met += distance < margin + 1e-3;
      now = next;
    }
  }
  EXPECT_GT(met, 100) << "hardly any of them met";
}

// As the lab starts, or where one was put by hand. Guards a hand that was held fast for ever.
TEST_P(EveryPair, WhoIsInAnotherLeavesItAwayFromItsMiddle) {
  Random random(13);
  const auto theirs = other_at(Pose::Identity());
  const Vector3d middle = middle_of(theirs);
  for (int round = 0; round < 30; ++round) {
    OtherHands others(hand_);
    others.observe("other", theirs);
    Pose now = drawn_pose(random, 0.05);
    const Pose start = now;
    const Vector3d away = (start.translation() - middle).normalized();
    Pose outside = start;
    outside.pretranslate((ours_.reach() + theirs_.reach() + 0.1) * away);
    for (int frame = 0; frame < 90; ++frame)
      now = others.go(now, limit_step(now, outside, 0.033, 0.1), open_);
    EXPECT_LT((now.translation() - outside.translation()).norm(), 1e-6) << round;
    // And what comes back comes no nearer than any other.
    for (int frame = 0; frame < 90; ++frame)
      now = others.go(now, limit_step(now, start, 0.033, 0.1), open_);
    EXPECT_GT(distance_between(ours_.at(now, open_), theirs), margin - rounding) << round;
    others.remove("other");
    EXPECT_TRUE(others.go(now, start, open_).isApprox(start)) << "nobody is there any more";
  }
}

TEST_P(EveryPair, WhoIsInAnotherComesNoDeeperTowardItsMiddle) {
  Random random(17);
  const auto theirs = other_at(Pose::Identity());
  OtherHands others(hand_);
  others.observe("other", theirs);
  for (int round = 0; round < 30; ++round) {
    const Pose start = drawn_pose(random, 0.05);
    // As far as between two looks.
    const Pose deeper = limit_step(
        start, make_pose(middle_of(theirs), Eigen::Quaterniond(start.linear())), 0.004, 0);
    const double before = distance_between(ours_.at(start, open_), theirs);
    const Pose next = others.go(start, deeper, open_);
    EXPECT_GT(distance_between(ours_.at(next, open_), theirs), std::min(before, margin) - rounding);
  }
}

INSTANTIATE_TEST_SUITE_P(Hands, EveryPair, testing::ValuesIn(test::hand_names()),
                         [](const auto& one) { return one.param; });

// What is in the way is passed by, not run into and not stood before.
TEST(OtherHands, AreSlidPast) {
  OtherHands others(barrett());
  const Eigen::VectorXd open = barrett().postures().at("open");
  others.observe("ball", {{Vector3d(0, 0, 0), Vector3d(0, 0, 0), 0.05}});
  Pose now = make_pose({0.5, 0.02, 0});
  const Pose goal = make_pose({-0.5, 0.02, 0});
  for (int frame = 0; frame < 200; ++frame)
    now = others.go(now, limit_step(now, goal, 0.033, 0.1), open);
  EXPECT_LT((now.translation() - goal.translation()).norm(), 1e-6);
}

// The whole mapping: a person reaches to where another robot hand is.
TEST(OtherHands, AreKeptOffByTheMapping) {
  const MappingModel model = random_model(1);
  auto mapping = Mapping::create(barrett(), model, {});
  ASSERT_TRUE(mapping);
  const auto theirs =
      HandCapsules(barrett()).at(make_pose({0.3, 0, 0.2}), barrett().postures().at("open"));
  mapping->on_other_hand("left", theirs);
  Time now{};
  Pose X_WB = Pose::Identity();
  for (int frame = 0; frame < 150; ++frame) {
    now += std::chrono::milliseconds(33);
    const Pose X_WH = make_pose({-0.3 + 0.004 * frame, 0, 0.2});
    const auto command = mapping->on_posture({now, now, X_WH, 1.0, tips({})}, now);
    if (!command) continue;  // no state yet
    X_WB = command->X_WB;
    EXPECT_GT(distance_between(HandCapsules(barrett()).at(X_WB, command->dof), theirs),
              margin - 1e-3)
        << frame;  // fingers may move on
  }
  EXPECT_GT(X_WB.translation().x(), -0.1) << "it went there";
}

}  // namespace
}  // namespace prehend::mapping
