// What a mapping takes from a posture, and which grasp it thinks it is.
#include "services/mapping/core/features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/mapping/core/grasp_type.hpp"
#include "tests/support/hands.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

TEST(Features, DoNotDependOnTheSizeOfTheHand) {
  const auto posture = model::HumanHand::posture({0.3, 0.5, 0.5, 0.2, 0.2});
  const auto reference = features(tips({0.3, 0.5, 0.5, 0.2, 0.2}), 1.0);
  ASSERT_TRUE(reference);
  for (const double scale : {0.8, 0.95, 1.2}) {
    const auto poses = model::HumanHand(scale).fingertip_poses(posture);
    Fingertips scaled;
    for (std::size_t f = 0; f < poses.size(); ++f) scaled[f] = {true, poses[f].translation()};
    const auto found = features(scaled, scale);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->isApprox(*reference, 1e-12));  // one product and one quotient
  }
}

TEST(Features, NeedThumbIndexAndLittleOnly) {
  auto some = tips({});
  some[static_cast<std::size_t>(model::Finger::middle)].valid = false;
  some[static_cast<std::size_t>(model::Finger::ring)].p_HF.setConstant(1e9);
  EXPECT_TRUE(features(some, 1));
  for (const auto finger : {model::Finger::thumb, model::Finger::index, model::Finger::little}) {
    auto bad = tips({});
    bad[static_cast<std::size_t>(finger)].valid = false;
    EXPECT_FALSE(features(bad, 1));
    bad = tips({});
    bad[static_cast<std::size_t>(finger)].p_HF.y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(features(bad, 1));
    bad = tips({});
    bad[static_cast<std::size_t>(finger)].p_HF.x() = 2;
    EXPECT_FALSE(features(bad, 1));
  }
  EXPECT_FALSE(features(tips({}), 0));
  EXPECT_FALSE(features(tips({}), std::numeric_limits<double>::quiet_NaN()));
}

TEST(Features, BendingIsZeroOpenAndOneInAFist) {
  const Eigen::Vector3d open = bending(*features(tips({}), 1));
  const Eigen::Vector3d fist = bending(*features(tips({1, 1, 1, 1, 1}), 1));
  EXPECT_TRUE(open.isZero(1e-12));
  EXPECT_TRUE(fist.isApprox(Eigen::Vector3d::Ones(), 1e-12));
}

Pose palm(const Eigen::Vector3d& approach, const Eigen::Vector3d& closing) {
  Eigen::Matrix3d R;
  R << closing.cross(approach), closing, approach;
  return make_pose(Eigen::Vector3d::Zero(), R);
}

TEST(GraspType, FollowsApproachAndFingers) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  const Pose side = palm(x, z.cross(x)), above = palm(-z, x);
  for (const bool precision : {false, true}) {
    EXPECT_EQ(grasp_type(0.1, side, precision), GraspType::none);
    EXPECT_EQ(grasp_type(0.1, above, precision), GraspType::none);
    EXPECT_EQ(grasp_type(1.2, side, precision), GraspType::power_wrap);
  }
  EXPECT_EQ(grasp_type(1.2, above, false), GraspType::circular_sphere);
  EXPECT_EQ(grasp_type(1.2, above, true), GraspType::precision);
}

TEST(GraspType, ClosingIsTheMeanFromTheOpenEnd) {
  for (const std::string& name : test::hand_names()) {
    const model::HandModel& hand = test::hand(name);
    Eigen::VectorXd open(static_cast<Eigen::Index>(hand.dofs().size())), closed = open;
    double range = 0;
    int count = 0;
    for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
      const model::HandDof& dof = hand.dofs()[i];
      const bool up = dof.closing > 0;
      open[static_cast<Eigen::Index>(i)] = up ? dof.lower : dof.upper;
      closed[static_cast<Eigen::Index>(i)] = up ? dof.upper : dof.lower;
      if (dof.closing == 0) continue;
      range += dof.upper - dof.lower;
      ++count;
    }
    EXPECT_NEAR(mean_closing(hand, open), 0, 1e-12) << name;
    EXPECT_NEAR(mean_closing(hand, closed), count == 0 ? 0 : range / count, 1e-12) << name;
  }
}

}  // namespace
}  // namespace prehend::mapping
