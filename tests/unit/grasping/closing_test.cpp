// Closing a hand on the objects of [Thesis]: every grasp that is found must touch with
// all fingers, resist any wrench and hold the object's weight.
#include "common/grasping/closing.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;
using model::ShapeKind;

const model::HandModel& barrett() {
  return test::hand("barrett");
}

/// Object's z along x of G (held from the side) or against z of G (held from above).
Pose in_base(bool from_above, double depth) {
  Eigen::Matrix3d R;
  if (from_above) {
    R.col(2) = -Vector3d::UnitZ();
    R.col(0) = Vector3d::UnitY();
  } else {
    R.col(2) = Vector3d::UnitX();
    R.col(0) = Vector3d::UnitY();
  }
  R.col(1) = R.col(2).cross(R.col(0));
  return barrett().X_BG() * make_pose(Vector3d(0, 0, depth), R);
}

struct Case {
  Body body;
  bool from_above;
};

class Closing : public testing::TestWithParam<Case> {};

TEST_P(Closing, GivesAGraspThatHolds) {
  const auto& [body, from_above] = GetParam();
  const double half = model::half_extents(body.shape).z();
  const Pose X_BO = in_base(from_above, from_above ? half - std::min(0.04, 2 * half - 0.04) : 0);
  ClosingOptions options;
  options.hold_test = HoldOptions{};
  options.down_B = -X_BO.linear().col(2);
  const auto grasp = close_hand(barrett(), body, X_BO, VectorXd::Zero(4), options);
  ASSERT_TRUE(grasp) << grasp.error().message();
  EXPECT_GE(grasp->contacts.size(), 3u);
  EXPECT_GT(grasp->quality.epsilon, 0.01);
  EXPECT_TRUE(grasp->hold->held) << grasp->hold->reason;
  EXPECT_LT((grasp->X_BO.translation() - X_BO.translation()).norm(), 0.01);
  // Wider objects stop the fingers sooner; all must be between open and closed.
  for (int i = 1; i < 4; ++i) {
    EXPECT_GT(grasp->dof[i], 0.8);
    EXPECT_LT(grasp->dof[i], 1.6);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Objects, Closing,
    testing::Values(
        Case{{"r15", {ShapeKind::cylinder, {0.015, 0.015, 0.145}}, 0.10, "plastic", {}}, false},
        Case{{"r37", {ShapeKind::cylinder, {0.037, 0.037, 0.230}}, 0.20, "wood", {}}, false},
        Case{{"43 mm cube", {ShapeKind::box, {0.043, 0.043, 0.043}}, 0.05, "wood", {}}, true},
        Case{{"67 mm box", {ShapeKind::box, {0.067, 0.225, 0.148}}, 0.35, "wood", {}}, true}));

const Body talc{"Talc", {ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};

TEST(CloseHand, IsDeterministic) {
  const auto a = close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(4));
  const auto b = close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(4));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->dof, b->dof);
  EXPECT_EQ(a->quality.epsilon, b->quality.epsilon);
}

TEST(CloseHand, AFixedObjectStaysAndGivesNearlyTheSamePosture) {
  ClosingOptions fixed;
  fixed.fixed_object = true;
  const auto free = close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(4));
  const auto held = close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(4), fixed);
  ASSERT_TRUE(free && held);
  // The base, heavy but not infinitely so, yields by micrometres.
  EXPECT_LT((held->X_BO.translation() - in_base(false, 0).translation()).norm(), 1e-5);
  EXPECT_LT((free->dof - held->dof).norm(), 0.05);
}

TEST(CloseHand, SaysWhyThereIsNoGrasp) {
  EXPECT_FALSE(
      close_hand(barrett(), talc, in_base(false, 0.5), VectorXd::Zero(4)));  // out of reach
  EXPECT_FALSE(
      close_hand(barrett(), talc, in_base(false, -0.06), VectorXd::Zero(4)));  // in the palm
  EXPECT_FALSE(close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(3)));
  Body bad = talc;
  bad.shape.size.x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(close_hand(barrett(), bad, in_base(false, 0), VectorXd::Zero(4)));
  ClosingOptions options;
  options.down_B.setZero();
  EXPECT_FALSE(close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(4), options));
  for (double ClosingOptions::*number :
       {&ClosingOptions::longest, &ClosingOptions::speed, &ClosingOptions::squeeze}) {
    options = {};
    options.*number = -1;
    const auto none = close_hand(barrett(), talc, in_base(false, 0), VectorXd::Zero(4), options);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().what, "time and speed must be positive, the squeeze 0 or more");
  }
}

}  // namespace
