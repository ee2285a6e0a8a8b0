// Hands that are sold, against what their makers publish of them: how far they open, how long they
// are, and that their pads stay face to face.
#include <gtest/gtest.h>

#include <cmath>

#include "common/model/hand_model.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Sold {
  const char* name;
  double opening, length, mass;  // m, of the pads apart and of the whole, closed; kg
};

class Grippers : public testing::TestWithParam<Sold> {};

TEST_P(Grippers, PadsStayFaceToFaceFromWhereTheyAreOpenUntilTheyMeet) {
  const model::HandModel& hand = test::hand(GetParam().name);
  ASSERT_EQ(hand.dofs().size(), 1u);
  const auto turn_of = [&](const std::vector<Pose>& poses, const model::HandFingertip& tip) {
    return poses[static_cast<std::size_t>(tip.link)].linear();
  };
  const auto& tips = hand.fingertips();
  double before = 1;
  for (int step = 0; step <= 20; ++step) {
    const double share = step / 20.0;
    const VectorXd dof = VectorXd::Constant(1, share * hand.dofs()[0].upper);
    const auto poses = hand.link_poses(hand.joint_angles(dof));
    const auto places = hand.fingertip_positions(dof);
    const Vector3d apart = places[0] - places[1];
    EXPECT_LT(std::hypot(apart.x(), apart.z()), 1e-9) << share;
    for (const model::HandFingertip& tip : tips)
      EXPECT_LT((turn_of(poses, tip) - Eigen::Matrix3d::Identity()).norm(), 1e-9) << share;
    EXPECT_LT(apart.y(), before);
    before = apart.y();
    if (step == 0) {
      EXPECT_NEAR(apart.y(), GetParam().opening, 5e-4);
    }
  }
  EXPECT_NEAR(before, 0, 5e-4);
}

TEST_P(Grippers, WeighAndReachAsFarAsIsPublished) {
  const model::HandModel& hand = test::hand(GetParam().name);
  const auto poses = hand.link_poses(hand.joint_angles(hand.postures().at("closed")));
  double mass = 0, lowest = 0, highest = 0;
  for (std::size_t i = 0; i < hand.links().size(); ++i) {
    mass += hand.links()[i].mass;
    for (const auto& part : hand.links()[i].collision) {
      const Vector3d half = model::half_extents(part.shape);
      const Pose X = poses[i] * part.X_LS;
      const double reach = X.linear().row(2).cwiseAbs().dot(half);
      lowest = std::min(lowest, X.translation().z() - reach);
      highest = std::max(highest, X.translation().z() + reach);
    }
  }
  EXPECT_NEAR(mass, GetParam().mass, 0.01);
  EXPECT_NEAR(highest - lowest, GetParam().length, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Robotiq, Grippers,
                         testing::Values(Sold{"robotiq_2f85", 0.085, 0.1628, 0.9},
                                         Sold{"robotiq_2f140", 0.14, 0.2328, 1.0}),
                         [](const auto& sold) { return std::string(sold.param.name); });

// Four fingers of one motor each, and a thumb of two; both joints of a finger turn together.
TEST(InspireHand, HasSixMotorsWithTheRangesOfTheRealOne) {
  const model::HandModel& hand = test::hand("inspire_rh56");
  ASSERT_EQ(hand.dofs().size(), 6u);
  std::vector<int> moved(6);
  for (const model::HandJoint& joint : hand.joints()) ++moved[static_cast<std::size_t>(joint.dof)];
  EXPECT_EQ(moved, (std::vector<int>{2, 2, 2, 2, 3, 1}));
  const double ranges[][2] = {{0, 1.7}, {0, 1.7}, {0, 1.7}, {0, 1.7}, {0, 0.5}, {-0.1, 1.3}};
  for (std::size_t d = 0; d < 6; ++d) {
    EXPECT_DOUBLE_EQ(hand.dofs()[d].lower, ranges[d][0]);
    EXPECT_DOUBLE_EQ(hand.dofs()[d].upper, ranges[d][1]);
  }
}

}  // namespace
