// How hands sit on a flange, and which an arm can carry.
#include "common/arm/mounting.hpp"

#include <gtest/gtest.h>

#include "tests/support/arms/arms.hpp"
#include "tests/support/hands.hpp"

using namespace prehend;

namespace {

TEST(Mounting, EveryHandSitsOnTheFlangeHoweverItIsBent) {
  for (const std::string& name : test::hand_names())
    for (const double bend : {0.0, 0.3, 0.7, 1.2}) {
      const model::HandModel& hand = test::hand(name);
      const Pose X_FB = arm::mounted(hand, bend);
      double lowest = 1;
      for (const model::CollisionShape& shape : hand.links().front().collision) {
        const Pose X_FS = X_FB * shape.X_LS;
        const Eigen::Vector3d half = model::half_extents(shape.shape);
        lowest =
            std::min(lowest, X_FS.translation().z() - X_FS.linear().row(2).cwiseAbs().dot(half));
      }
      EXPECT_GE(lowest, -1e-9) << name << " " << bend;
      const Eigen::Matrix3d R_FG = (X_FB * hand.X_BG()).linear();
      EXPECT_NEAR(angle_between(R_FG, Eigen::Matrix3d::Identity()), bend, 1e-6) << name;
      EXPECT_NEAR(R_FG.col(1).y(), 1, 1e-9) << name;
    }
}

TEST(Mounting, AHandThatIsTooHeavyIsRefusedWithBothNames) {
  const model::ArmModel& puma = test::arm("puma560");
  EXPECT_TRUE(arm::check_fit(puma, test::hand("barrett")));
  EXPECT_TRUE(arm::check_fit(puma, test::hand("dlr")));
  const auto fits = arm::check_fit(puma, test::hand("robonaut"));
  ASSERT_FALSE(fits);
  EXPECT_EQ(fits.error().exit, exit_wrong_use);
  EXPECT_EQ(fits.error().message(),
            "puma560: cannot carry robonaut, which weighs 2.75 kg; its payload is 2.50 kg "
            "(choose a lighter hand or a stronger arm)");
  model::ArmModel silent = puma;
  silent.payload = 0;  // nobody says
  EXPECT_TRUE(arm::check_fit(silent, test::hand("robonaut")));
}

}  // namespace
