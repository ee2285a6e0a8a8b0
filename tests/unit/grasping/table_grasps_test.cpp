// Grasps of what stands on a table: every one that is found holds as the mapping closes it, near
// where it was asked for, whatever the threads; and what cannot be grasped is told from what can.
#include "common/grasping/table_grasps.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "common/base/workers.hpp"
#include "common/model/past_contact.hpp"
#include "tests/support/hands.hpp"

namespace prehend::grasping {
namespace {

void in_turn(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

void in_threads(std::size_t count, const std::function<void(std::size_t)>& work) {
  share_work(count, 3, work, [](std::size_t) {});
}

Body bottle() {
  return {"bottle", {model::ShapeKind::cylinder, {0.024, 0.024, 0.14}}, 0.15, "plastic", {}, {}};
}
Body brick() {
  return {"brick", {model::ShapeKind::box, {0.036, 0.1, 0.12}}, 0.3, "wood", {}, {}};
}

std::vector<SureGrasp> found(const model::HandModel& hand, const Body& object,
                             const SearchOptions& options, const ForEach& for_each = in_threads) {
  auto search = TableGraspSearch::create(hand, object, options).value();
  while (search.try_next(for_each)) {
  }
  return search.found();
}

class TableGrasps : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand = test::hand(GetParam());
};

TEST_P(TableGrasps, HoldAreNearTheirApproachAndWithinLimits) {
  for (const Body& object : {bottle(), brick()}) {
    const auto ways = approaches(object.shape, hand.reach());
    const auto grasps = found(hand, object, {.attempts = 4, .at_once = 2});
    EXPECT_LE(grasps.size(), ways.size());
    double last = 1;
    for (const SureGrasp& grasp : grasps) {
      const TableGrasp& made = grasp.grasp;
      EXPECT_LE(grasp.room, last) << "the surest comes first";
      last = grasp.room;
      EXPECT_TRUE(std::any_of(ways.begin(), ways.end(),
                              [&](const Pose& way) { return way.isApprox(grasp.X_OG); }));
      const Pose off = grasp.X_OG.inverse() * made.X_OG;
      EXPECT_LT(off.translation().norm(), 0.02);
      EXPECT_LT(angle_between(off.linear(), Eigen::Matrix3d::Identity().eval()), 0.2);
      EXPECT_EQ(made.dof, hand.clamp(made.dof));
      EXPECT_EQ(made.open, hand.clamp(made.open));
      EXPECT_TRUE(held_on_table(hand, object, made, {.hold = 1, .shake = true})) << object.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, TableGrasps, testing::ValuesIn(test::mappable_hands()),
                         [](const auto& each) { return each.param; });

TEST(TableGraspSearch, AnswersTheSameHoweverTheWorkIsDivided) {
  const auto& hand = test::hand("barrett");
  const SearchOptions options{.attempts = 4, .at_once = 2};
  const auto one = found(hand, bottle(), options, in_turn);
  const auto three = found(hand, bottle(), options, in_threads);
  ASSERT_FALSE(one.empty());
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].tried, three[i].tried);
    EXPECT_EQ(one[i].room, three[i].room);
    EXPECT_EQ(one[i].grasp.dof, three[i].grasp.dof);
    EXPECT_EQ(one[i].grasp.X_OG.matrix(), three[i].grasp.X_OG.matrix());
  }
}

TEST(TableGraspSearch, MoreAttemptsFindNothingWorse) {
  const auto& hand = test::hand("dlr");
  const auto room = [&](int attempts) {
    const auto grasps = found(hand, brick(), {.attempts = attempts, .at_once = 2});
    return std::accumulate(grasps.begin(), grasps.end(), 0.0,
                           [](double sum, const SureGrasp& grasp) { return sum + grasp.room; });
  };
  EXPECT_GE(room(6), room(2));
}

// Guards: what two fingers pinch from above was pushed out by the third, which went on.
TEST(TableGraspSearch, FingersDoNotGoOnWhereThatLosesWhatIsSure) {
  const auto& hand = test::hand("barrett");
  const Body thin{"thin", {model::ShapeKind::cylinder, {0.015, 0.015, 0.145}}, 0.1, "plastic", {},
                  {}};
  const auto grasps = found(hand, thin, {});
  ASSERT_EQ(grasps.size(), 2u);
  for (const SureGrasp& grasp : grasps) {
    ASSERT_GE(grasp.room, SearchOptions{}.enough);
    ASSERT_EQ(grasp.follow_through == 0, is_from_above(grasp.X_OG)) << grasp.follow_through;
    if (grasp.follow_through > 0) continue;
    int held = 0, held_pressed = 0;
    for (const double off : {-0.0012, -0.0006, 0.0006, 0.0012}) {  // m
      TableGrasp there = grasp.grasp;
      there.X_OG = there.X_OG * make_pose({off, off, 0});
      held += held_on_table(hand, thin, there, {.hold = 1, .shake = true});
      there.dof = model::past_contact(hand, there.open, there.dof, there.closing,
                                      model::full_follow_through);
      held_pressed += held_on_table(hand, thin, there, {.hold = 1, .shake = true});
    }
    EXPECT_GE(held, 3);
    EXPECT_LE(held_pressed, 1);
  }
}

// Guards: the first of two fingers with one motor stopped the other at a distance from the object;
// the published Robotiq had no grasp at all.
TEST(OneMotor, PushesWhatStandsBetweenTwoFingersIntoTheirMiddle) {
  const auto hand = test::coupled_hand("parallel_jaw", "rigid");
  for (const double off : {-0.004, 0.004}) {  // m, of the hand from above the object
    const Pose X_OG = approaches(bottle().shape, hand.reach()).front() * make_pose({0, off, 0});
    const auto grasp = close_on_table(hand, bottle(), {X_OG, hand.postures().at("open"), {}});
    ASSERT_TRUE(grasp) << grasp.error().message();
    EXPECT_NEAR(grasp->dof[0], bottle().shape.size.x(), 0.001) << "both touch";
    EXPECT_TRUE(held_on_table(hand, bottle(), *grasp, {.hold = 1, .shake = true}));
  }
  EXPECT_EQ(found(hand, bottle(), {.judged = 1}).size(), 2u);
}

// Guards: attempts were used up by open hands that stood in the table; no grasp was found.
TEST(LowObject, OpenHandsThatStandInTheTableUseUpNoAttempt) {
  const Body talc{"talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {},
                  {}};
  EXPECT_FALSE(found(test::hand("dlr"), talc, {.enough = 0.3, .judged = 1}).empty());
}

TEST(TableGraspSearch, EndsAtOnceWhereNothingFits) {
  Body wall = brick();
  wall.shape.size.setConstant(0.6);
  auto search = TableGraspSearch::create(test::hand("barrett"), wall).value();
  EXPECT_FALSE(search.try_next(in_turn));
  EXPECT_TRUE(search.found().empty());
  EXPECT_EQ(search.attempts(), 0);
}

TEST(TableGraspSearch, SaysWhyNothingHolds) {
  Body lead = bottle();
  lead.mass = 30;
  auto search = TableGraspSearch::create(test::hand("barrett"), lead, {.attempts = 1}).value();
  EXPECT_FALSE(search.try_next(in_turn));
  EXPECT_TRUE(search.found().empty());
  EXPECT_GE(search.attempts(), 1);
  int refused = 0;
  for (const auto& [reason, count] : search.refused()) refused += count;
  EXPECT_EQ(refused, search.attempts());
}

TEST(TableGraspSearch, RefusesObjectsAndOptionsThatCannotBe) {
  const auto& hand = test::hand("barrett");
  Body none = bottle();
  none.mass = 0;
  EXPECT_FALSE(TableGraspSearch::create(hand, none));
  none = bottle();
  none.shape.kind = model::ShapeKind::unknown;
  EXPECT_FALSE(TableGraspSearch::create(hand, none));
  EXPECT_FALSE(TableGraspSearch::create(hand, bottle(), {.attempts = 0}));
  EXPECT_FALSE(TableGraspSearch::create(hand, bottle(), {.at_once = 0}));
}

// What the mapping commands past contact: all fingers arrive together, none beyond its limits.
TEST(PastContact, GoesOnInProportionToTheWayOfEachFinger) {
  const auto& hand = test::hand("barrett");
  const auto grasp = close_on_table(
      hand, bottle(),
      {approaches(bottle().shape, hand.reach()).back(), hand.postures().at("open"), {}});
  ASSERT_TRUE(grasp) << grasp.error().message();
  const Eigen::VectorXd past =
      model::past_contact(hand, grasp->open, grasp->dof, grasp->closing, 0.3);
  EXPECT_EQ(past, hand.clamp(past));
  double most = 0;
  for (Eigen::Index i = 0; i < past.size(); ++i) {
    const double on = (past[i] - grasp->dof[i]) * grasp->closing[i];
    EXPECT_GE(on, -1e-12);
    if (grasp->closing[i] == 0) {
      EXPECT_EQ(past[i], grasp->dof[i]);
    }
    most = std::max(most, on);
  }
  EXPECT_NEAR(most, 0.3, 0.05);
}

}  // namespace
}  // namespace prehend::grasping
