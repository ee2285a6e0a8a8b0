// What every plan must keep to, whatever hand and object: the same for a seed however the work is
// divided; every candidate is a tested grasp, one beyond those, or refused with a reason; grasps
// that held first, then by epsilon; contacts on the object's surface with normals into it, within
// 2 mm (Bullet's contact margin of 0.5 mm on both sides, and at most 1 mm of penetration).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "common/grasping/candidates.hpp"
#include "services/planner/tools/planning/grasp_file.hpp"
#include "tests/support/hands.hpp"
#include "tests/unit/planner/planning/plans.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using grasping::Body;
using grasping::Plan;
using grasping::PlannedGrasp;
using model::ShapeKind;

/// Distance from the surface and slope of it, by differences, at a contact.
void expect_on_surface(const model::Shape& shape, const analysis::Contact& contact) {
  EXPECT_LT(std::abs(model::signed_distance(shape, contact.p_OC)), 0.002);
  EXPECT_NEAR(contact.normal_O.norm(), 1, 1e-9);
  // 5 mm along the normal one is deeper inside than 5 mm against it.
  EXPECT_LT(model::signed_distance(shape, contact.p_OC + 0.005 * contact.normal_O),
            model::signed_distance(shape, contact.p_OC - 0.005 * contact.normal_O));
  EXPECT_GE(contact.friction, 0);
  EXPECT_GT(contact.force, 0);
}

void expect_sound(const Plan& plan) {
  EXPECT_EQ(std::accumulate(plan.refused.begin(), plan.refused.end(), plan.closed,
                            [](int sum, const auto& reason) { return sum + reason.second; }) >=
                plan.options.candidates,
            true);
  for (const auto& [reason, count] : plan.refused) {
    EXPECT_FALSE(reason.empty());
    EXPECT_GT(count, 0);
  }
  EXPECT_EQ(plan.held(), plan.reason.empty());
  const model::HandModel& hand = test::hand(plan.hand);
  for (std::size_t i = 0; i < plan.grasps.size(); ++i) {
    const PlannedGrasp& grasp = plan.grasps[i];
    if (i > 0) {
      const PlannedGrasp& better = plan.grasps[i - 1];
      EXPECT_GE(std::pair(better.hold.held, better.quality.epsilon),
                std::pair(grasp.hold.held, grasp.quality.epsilon));
    }
    EXPECT_GT(grasp.quality.epsilon, 0);
    EXPECT_EQ(grasp.hold.held, grasp.hold.reason.empty());
    EXPECT_TRUE(is_finite(grasp.X_OB) && is_finite(grasp.X_OB_before));
    EXPECT_TRUE(grasp.dof.allFinite() && grasp.joints.allFinite());
    EXPECT_EQ(grasp.preshape, hand.clamp(grasp.preshape));
    EXPECT_GE(grasp.contacts.size(), 2u);
    EXPECT_LE(grasp.contacts.size(), 10u);
    EXPECT_TRUE(grasp.wrenches.allFinite());
    for (const analysis::Contact& contact : grasp.contacts)
      expect_on_surface(plan.object.shape, contact);
    // The wrenches that are kept are those that were judged.
    EXPECT_DOUBLE_EQ(analysis::wrench_quality(grasp.wrenches)->epsilon, grasp.quality.epsilon);
    // It stood clear of the object before it closed.
    auto world = grasping::World::create(hand, grasp.X_OB_before, grasp.preshape,
                                         {.table = false, .gravity_W = Vector3d::Zero()});
    ASSERT_TRUE(world);
    ASSERT_TRUE((*world)->add_body(plan.object, Pose::Identity()));
    EXPECT_GT((*world)->distance_to_hand(0), 0.001);
  }
}

TEST(PlanGrasps, OneThreadAndTwoGiveEqualBytes) {
  const grasping::PlanOptions options{.candidates = 10, .seed = 7, .tested = 2, .max_tested = 2};
  const std::string alone = serialise(plan("barrett", talc, options, 1));
  EXPECT_EQ(alone, serialise(plan("barrett", talc, options, 2)));
  grasping::PlanOptions other = options;
  other.seed = 8;
  EXPECT_NE(alone, serialise(plan("barrett", talc, other, 2)));
}

TEST(PlanGrasps, BarrettHoldsACylinder) {
  const Plan& planned = barrett_on_talc();
  expect_sound(planned);
  ASSERT_TRUE(planned.held()) << planned.reason;
  EXPECT_GT(planned.grasps.front().quality.epsilon, 0.05);
}

class EveryHand : public testing::TestWithParam<std::string> {};

TEST_P(EveryHand, GivesSoundPlans) {
  const Body cube{"cube", {ShapeKind::box, {0.043, 0.043, 0.043}}, 0.05, "wood", {}};
  const Body ball{"ball", {ShapeKind::sphere, Vector3d::Constant(0.03)}, 0.1, "rubber", {}};
  const int candidates = std::getenv("PREHEND_LONG") ? 60 : 3;
  for (const Body& object : {talc, cube, ball})
    expect_sound(
        plan(GetParam(), object, {.candidates = candidates, .tested = 1, .max_tested = 1}));
}

TEST_P(EveryHand, IsToldWhatDoesNotFit) {
  const Body crate{"crate", {ShapeKind::box, {0.5, 0.6, 0.7}}, 1, "wood", {}};
  const Plan planned = plan(GetParam(), crate, {.candidates = 2, .tested = 1, .max_tested = 1});
  EXPECT_FALSE(planned.held());
  EXPECT_NE(planned.reason.find("wider than the hand's opening"), std::string::npos)
      << planned.reason;
}

TEST_P(EveryHand, CandidatesDependOnSeedAndIndexAlone) {
  const model::HandModel& hand = test::hand(GetParam());
  for (int i = 0; i < 200; ++i) {
    const auto a = grasping::sample_candidate(hand, talc.shape, 5, i);
    const auto b = grasping::sample_candidate(hand, talc.shape, 5, i);
    EXPECT_TRUE(a.X_OG.isApprox(b.X_OG, 0));
    EXPECT_EQ(a.preshape, b.preshape);
    EXPECT_EQ(a.preshape, hand.clamp(a.preshape));
    EXPECT_NEAR(a.X_OG.linear().determinant(), 1, 1e-9);
    EXPECT_FALSE(a.X_OG.isApprox(grasping::sample_candidate(hand, talc.shape, 5, i + 1).X_OG));
    EXPECT_FALSE(a.X_OG.isApprox(grasping::sample_candidate(hand, talc.shape, 6, i).X_OG));
  }
}

INSTANTIATE_TEST_SUITE_P(Hands, EveryHand, testing::ValuesIn(test::hand_names()),
                         [](const auto& hand) { return hand.param; });

TEST(PlanGrasps, NothingReachesThroughTheTable) {
  const Body cube{"cube", {ShapeKind::box, {0.06, 0.06, 0.06}}, 0.1, "wood", {}};
  const Plan planned =
      plan("barrett", cube, {.candidates = 24, .table = true, .tested = 4, .max_tested = 4});
  expect_sound(planned);
  EXPECT_GT(planned.refused.at("the hand is in the table"), 0);
  for (const PlannedGrasp& grasp : planned.grasps) {
    // The palm's origin is above the object's underside.
    EXPECT_GT(grasp.X_OB_before.translation().z(), -0.03);
  }
}

TEST(PlanGrasps, RefusesNonsense) {
  const auto refused = [](Body object, const grasping::PlanOptions& options) {
    return !grasping::plan_grasps(test::hand("barrett"), object, options,
                                  [](std::size_t, const auto&) {});
  };
  EXPECT_TRUE(refused(talc, {.candidates = 0}));
  EXPECT_TRUE(refused(talc, {.tested = 0}));
  EXPECT_TRUE(refused(talc, {.tested = 10, .max_tested = 5}));
  Body bad = talc;
  bad.shape.size.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(bad, {}));
  bad = talc;
  bad.mass = 0;
  EXPECT_TRUE(refused(bad, {}));
  bad = talc;
  bad.material = "jelly";
  EXPECT_TRUE(refused(bad, {}));
}

}  // namespace
}  // namespace prehend::planner
