// The answer without an object in every mode, for every hand: joints is the network's answer to the
// bit, the fingertips' modes do not depend on it, and combined lies on the line between the two, as
// far along as the grasp asks for. 1e-12: one product and one sum.
#include "services/mapping/core/direct_fingers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

class DirectFingersOf : public testing::TestWithParam<std::string> {
 protected:
  Eigen::VectorXd answer(DirectFingers& fingers, const Eigen::VectorXd& joints, GraspType grasp,
                         int ms = 30) {
    const auto made = fingers.answer(posture_, joints, open_, grasp, milliseconds(ms));
    EXPECT_TRUE(made) << made.error().message();
    return made.value_or(Eigen::VectorXd());
  }

  const model::HandModel& hand_ = test::hand(GetParam());
  Eigen::VectorXd open_ = hand_.clamp(hand_.postures().at("open"));
  Eigen::VectorXd middle_ = [this] {
    Eigen::VectorXd dof = open_;
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      const model::HandDof& d = hand_.dofs()[static_cast<std::size_t>(i)];
      dof[i] = 0.5 * (d.lower + d.upper);
    }
    return dof;
  }();
  Posture posture_{{}, {}, Pose::Identity(), 1, tips({0.4, 0.4, 0.4, 0.4, 0.4})};
};

TEST_P(DirectFingersOf, OfJointsIsTheNetworks) {
  DirectFingers fingers(hand_, milliseconds(300));
  EXPECT_EQ(answer(fingers, middle_, GraspType::precision), middle_);
  // It needs no fingertips of its own.
  posture_.fingertips = {};
  EXPECT_EQ(answer(fingers, open_, GraspType::precision), open_);
}

TEST_P(DirectFingersOf, OfFingertipsDoesNotDependOnTheNetwork) {
  for (const FingerMode mode : {FingerMode::cartesian, FingerMode::retargeting}) {
    DirectFingers fingers(hand_, milliseconds(300));
    ASSERT_TRUE(fingers.use(mode));
    const Eigen::VectorXd made = answer(fingers, middle_, GraspType::precision);
    EXPECT_EQ(answer(fingers, open_, GraspType::none), made);
    EXPECT_EQ(hand_.clamp(made), made);
    posture_.fingertips[0].valid = false;  // the thumb: every hand follows it
    EXPECT_FALSE(
        fingers.answer(posture_, open_, open_, GraspType::none, milliseconds(30)).has_value());
    posture_.fingertips[0].valid = true;
  }
}

TEST_P(DirectFingersOf, CombinedGoesFromJointsToFingertipsAsTheGraspAsks) {
  DirectFingers cartesian(hand_, milliseconds(300)), combined(hand_, milliseconds(300));
  ASSERT_TRUE(cartesian.use(FingerMode::cartesian));
  ASSERT_TRUE(combined.use(FingerMode::combined));
  const Eigen::VectorXd by_tips = answer(cartesian, middle_, GraspType::none);
  const auto at = [&](double share) {
    return Eigen::VectorXd(middle_ + share * (by_tips - middle_));
  };
  const auto expect = [&](GraspType grasp, int ms, double share) {
    EXPECT_LT((answer(combined, middle_, grasp, ms) - at(share)).norm(), 1e-12) << share;
  };
  EXPECT_EQ(answer(combined, middle_, GraspType::none), middle_);
  for (int i = 1; i <= 12; ++i) expect(GraspType::precision, 30, std::min(1.0, 0.1 * i));
  expect(GraspType::circular_sphere, 1000, 0.5);
  expect(GraspType::power_wrap, 60, 0.3);
  // What was blended in stays when another mode is used in between.
  ASSERT_TRUE(combined.use(FingerMode::joints));
  EXPECT_EQ(answer(combined, middle_, GraspType::precision), middle_);
  ASSERT_TRUE(combined.use(FingerMode::combined));
  expect(GraspType::circular_sphere, 0, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Hands, DirectFingersOf, testing::ValuesIn(test::hand_names()));

}  // namespace
}  // namespace prehend::mapping
