// How hands stand on flanges, and what arms reach with them.
#include "common/arm/reach.hpp"

#include <gtest/gtest.h>

#include "common/arm/mounting.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/hands.hpp"

using namespace prehend;

namespace {

TEST(Mounting, EveryHandGraspsOnTheAxisAndItsBackIsOnTheFlange) {
  for (const std::string& name : test::hand_names()) {
    const model::HandModel& hand = test::hand(name);
    const Pose X_FB = arm::mounted(hand), X_FG = X_FB * hand.X_BG();
    EXPECT_LT((X_FG.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-9) << name;
    EXPECT_LT(X_FG.translation().head<2>().norm(), 1e-9) << name;
    EXPECT_GT(X_FG.translation().z(), 0) << name;
    double lowest = 1;
    for (const model::CollisionShape& shape : hand.links().front().collision)
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const Eigen::Vector3d p_S = sign.cwiseProduct(model::half_extents(shape.shape));
        lowest = std::min(lowest, (X_FB * shape.X_LS * p_S).z());
      }
    EXPECT_NEAR(lowest, 0, 1e-9) << name;
  }
}

TEST(Mounting, AllShapesOfTheHandAreCarried) {
  const model::ArmModel& puma = test::arm("puma560");
  for (const std::string& name : test::hand_names()) {
    std::size_t shapes = 0;
    for (const model::HandLink& link : test::hand(name).links()) shapes += link.collision.size();
    EXPECT_EQ(arm::carried(puma, test::hand(name)).size(), shapes) << name;
  }
}

// Published of the Puma: best with the shoulder 0.67 m above the table, where nearly all places are
// reached from above and most of them slanted; level, this task asks for more than the published
// one.
TEST(Reach, ThePumaReachesWhatItIsKnownToReach) {
  const model::ArmModel& puma = test::arm("puma560");
  arm::ReachTask task;
  task.X_EG.translate(Eigen::Vector3d(0, 0, 0.12));
  const arm::ReachRow row = arm::reach_at(puma, task, 0.67);
  for (const arm::Share& share : row.shares) {
    std::cout << share.limits << " " << share.free << "\n";
    EXPECT_LE(share.free, share.limits);
    EXPECT_LE(share.limits, 1);
  }
  EXPECT_GE(row.shares[0].limits, 0.9);
  EXPECT_GE(row.shares[1].limits, 0.8);
  EXPECT_GE(row.shares[2].limits, 0.5);
}

// Sixty sixtieths are 1, not a little more.
TEST(Reach, AShareIsNeverAboveOne) {
  arm::ReachTask task;
  task.X_EG.translate(Eigen::Vector3d(0, 0, 0.12));
  const arm::ReachRow row = arm::reach_at(test::arm("puma560"), task, 0.1);
  EXPECT_GT(row.shares[0].limits, 0.5);
  for (const arm::Share& share : row.shares) EXPECT_LE(share.limits, 1);
}

TEST(Reach, AnArmFarAboveReachesNothing) {
  const arm::ReachTask task;
  const arm::ReachRow row = arm::reach_at(test::arm("puma560"), task, 3);
  EXPECT_EQ(row.shares[0].limits, 0);
  EXPECT_EQ(row.least(), 0);
}

TEST(Reach, TheBestRowIsThatWithTheBestWorstApproach) {
  arm::ReachRow low{0.2, {{{1, 0.2}, {1, 1}, {1, 1}}}}, high{0.6, {{{1, 0.5}, {1, 0.5}, {1, 0.5}}}};
  EXPECT_EQ(arm::best({low, high}).height, 0.6);
}

}  // namespace
