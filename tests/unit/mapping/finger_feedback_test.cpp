// A finger of the wearer feels what the robot's finger feels that it leads, for every hand.
#include "services/mapping/core/finger_feedback.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/hands.hpp"

namespace prehend::mapping {
namespace {

using Eigen::VectorXd;

class EveryHand : public ::testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  std::vector<LinkTouch> untouched_ = std::vector<LinkTouch>(hand_.links().size());
  const VectorXd open_ = hand_.postures().at("open");
};

TEST_P(EveryHand, EachLinkIsFeltByTheFingerThatLeadsItsTipAndByNoOther) {
  for (std::size_t i = 0; i < untouched_.size(); ++i) {
    auto touch = untouched_;
    touch[i] = {.touching = true, .pressure = 3, .slipping = true};
    const auto felt = feel(hand_, touch, open_);
    ASSERT_TRUE(felt);
    const int finger = hand_.links()[i].finger;
    const auto human =
        finger < 0 ? std::nullopt : hand_.fingertips()[static_cast<std::size_t>(finger)].human;
    for (std::size_t f = 0; f < felt->size(); ++f) {
      const bool leads = human && static_cast<std::size_t>(*human) == f;
      EXPECT_EQ((*felt)[f].force, leads ? 3 : 0) << hand_.links()[i].name;
      EXPECT_EQ((*felt)[f].contact, leads);
      EXPECT_EQ((*felt)[f].slip, leads);
    }
  }
}

TEST_P(EveryHand, AClosedHandIsAtItsEndAndAnOpenOneIsNot) {
  VectorXd closed = open_, opened = open_;
  for (std::size_t i = 0; i < hand_.dofs().size(); ++i) {
    const model::HandDof& dof = hand_.dofs()[i];
    if (dof.closing == 0) continue;
    closed[static_cast<Eigen::Index>(i)] = dof.closing > 0 ? dof.upper : dof.lower;
    opened[static_cast<Eigen::Index>(i)] = dof.closing > 0 ? dof.lower : dof.upper;
  }
  const auto at_end = feel(hand_, untouched_, closed), free = feel(hand_, untouched_, opened);
  ASSERT_TRUE(at_end && free);
  bool any = false;
  for (std::size_t f = 0; f < at_end->size(); ++f) {
    any |= (*at_end)[f].limit;
    EXPECT_FALSE((*free)[f].limit);
    EXPECT_FALSE((*at_end)[f].contact);
  }
  EXPECT_TRUE(any);
}

TEST_P(EveryHand, WhatIsOfAnotherHandOrNotFiniteIsRefused) {
  auto longer = untouched_;
  longer.emplace_back();
  EXPECT_FALSE(feel(hand_, longer, open_));
  EXPECT_FALSE(feel(hand_, untouched_, VectorXd::Zero(open_.size() + 1)));
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    auto touch = untouched_;
    touch.back().pressure = wrong;
    EXPECT_FALSE(feel(hand_, touch, open_));
    EXPECT_FALSE(feel(hand_, untouched_, VectorXd::Constant(open_.size(), wrong)));
  }
  auto unmeasured = untouched_;
  for (LinkTouch& link : unmeasured) link = {.touching = true, .pressure = -1};
  const auto felt = feel(hand_, unmeasured, open_);
  ASSERT_TRUE(felt);
  for (const model::FingerFeedback& finger : *felt) EXPECT_EQ(finger.force, 0);
}

INSTANTIATE_TEST_SUITE_P(Hands, EveryHand, ::testing::ValuesIn(test::mappable_hands()));

}  // namespace
}  // namespace prehend::mapping
