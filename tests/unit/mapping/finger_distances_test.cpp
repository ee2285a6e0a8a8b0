// How near fingers are to an object, against the physics engine's own distance (GJK on the same
// collision shapes), for every hand in random postures. A small ball stands 2 cm off a fingertip,
// so that this finger is the nearest part of the hand. Sampling can only miss what is nearest, by
// at most spacing² / (8 · ball radius) = 0.8 mm on flat faces and by the rim of a cylinder that
// counts as a capsule, (√2 − 1) · radius = 5.6 mm of the thickest finger; Bullet rounds by its
// margin of 0.5 mm.
#include "services/mapping/core/finger_distances.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/grasping/world.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

class FingerDistancesOf : public testing::TestWithParam<std::string> {};

TEST_P(FingerDistancesOf, EqualsThePhysicalDistance) {
  const model::HandModel& hand = test::hand(GetParam());
  const FingerDistances fingers(hand);
  ASSERT_EQ(fingers.fingers(), static_cast<int>(hand.fingertips().size()));
  const model::Shape ball{model::ShapeKind::sphere, Eigen::Vector3d::Constant(0.01)};
  Random random(4);
  double sum = 0;
  int count = 0;
  for (int k = 0; k < 12; ++k) {
    Eigen::VectorXd dof = hand.postures().at("open");
    for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
      const model::HandDof& limits = hand.dofs()[i];
      double& q = dof[static_cast<Eigen::Index>(i)];
      if (limits.closing != 0)
        q += random.uniform(0, 0.4) * ((limits.closing > 0 ? limits.upper : limits.lower) - q);
    }
    const auto X_BL = hand.link_poses(hand.joint_angles(dof));
    for (std::size_t f = 0; f < hand.fingertips().size(); ++f) {
      const model::HandFingertip& tip = hand.fingertips()[f];
      const Pose X_BO = X_BL[static_cast<std::size_t>(tip.link)] *
                        make_pose(tip.p_LT + 0.03 * tip.p_LT.normalized());
      const auto world = grasping::World::create(hand, Pose::Identity(), dof, {.table = false});
      ASSERT_TRUE(world) << world.error().message();
      ASSERT_TRUE((*world)->add_body({"ball", ball, 0, "wood", {}, {}}, X_BO));
      const double real = (*world)->distance_to_hand(0, 0.2);
      const double found = fingers.distances(dof, ball, X_BO).minCoeff();
      EXPECT_GT(found, real - 0.001);
      EXPECT_LT(found, real + 0.006);
      sum += std::abs(found - real);
      ++count;
    }
  }
  EXPECT_LT(sum / count, 0.003);
}

TEST_P(FingerDistancesOf, FallsWhileAFingerClosesOnWhatItWillTouch) {
  const model::HandModel& hand = test::hand(GetParam());
  const FingerDistances fingers(hand);
  // In the middle of the closing fingers.
  const model::Shape ball{model::ShapeKind::sphere, Eigen::Vector3d::Constant(0.02)};
  Eigen::VectorXd dof = hand.postures().at("open");
  const Eigen::VectorXd open = fingers.distances(dof, ball, hand.X_BG());
  for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
    const model::HandDof& limits = hand.dofs()[i];
    double& q = dof[static_cast<Eigen::Index>(i)];
    if (limits.closing != 0) q += 0.3 * ((limits.closing > 0 ? limits.upper : limits.lower) - q);
  }
  EXPECT_LT(fingers.distances(dof, ball, hand.X_BG()).sum(), open.sum());
}

INSTANTIATE_TEST_SUITE_P(Mapping, FingerDistancesOf, testing::ValuesIn(test::hand_names()),
                         [](const auto& named) { return named.param; });

}  // namespace
}  // namespace prehend::mapping
