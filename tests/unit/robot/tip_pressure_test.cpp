// What the drives say of the fingertips: the pressures that are told explain the efforts by virtual
// work, of every hand, and what moves, opens or only overcomes friction presses nothing.
#include "services/robot/core/tip_pressure.hpp"

#include <gtest/gtest.h>

#include "common/analysis/grasp_map.hpp"
#include "common/model/hand_effort.hpp"
#include "services/robot/service/messages.hpp"
#include "tests/support/hands.hpp"

namespace prehend::robot {
namespace {

using Eigen::VectorXd;

VectorXd half_closed(const model::HandModel& hand) {
  VectorXd dof = hand.postures().at("open");
  for (Eigen::Index d = 0; d < dof.size(); ++d) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(d)];
    if (limits.closing != 0)
      dof[d] = 0.5 * (dof[d] + (limits.closing > 0 ? limits.upper : limits.lower));
  }
  return dof;
}

Reading at_rest(const VectorXd& dof, const VectorXd& effort) {
  return {Time{}, dof, VectorXd::Zero(dof.size()), effort, {}};
}

/// What the drives must bear while the tips press so.
VectorXd efforts(const model::HandModel& hand, const VectorXd& dof,
                 const std::vector<TipPressure>& tips) {
  std::vector<analysis::Contact> contacts;
  VectorXd forces = VectorXd::Zero(4 * static_cast<Eigen::Index>(tips.size()));
  for (std::size_t k = 0; k < tips.size(); ++k) {
    const auto link = static_cast<std::size_t>(hand.fingertips()[k].link);
    contacts.push_back(
        {.link = hand.links()[link].name, .p_OC = tips[k].p_BT, .normal_O = tips[k].way_B});
    forces.segment<3>(4 * static_cast<Eigen::Index>(k)) = tips[k].pressure * tips[k].way_B;
  }
  const auto jacobian =
      analysis::contact_jacobian(hand, hand.joint_angles(dof), Pose::Identity(), contacts);
  return analysis::coupling(hand).transpose() * jacobian.value().transpose() * forces;
}

class TipPressures : public testing::TestWithParam<std::string> {};

TEST_P(TipPressures, ExplainTheEfforts) {
  const model::HandModel& hand = test::hand(GetParam());
  const VectorXd dof = half_closed(hand);
  auto pressed = tip_pressures(hand, at_rest(dof, VectorXd::Zero(dof.size())));
  ASSERT_EQ(pressed.size(), hand.fingertips().size());
  for (std::size_t k = 0; k < pressed.size(); ++k) {
    EXPECT_FALSE(pressed[k].pressing);
    EXPECT_NEAR(pressed[k].way_B.norm(), 1, 1e-9) << hand.fingertips()[k].name;
    // More than friction, in every drive.
    pressed[k].pressure = 20 + static_cast<double>(k);
  }
  VectorXd effort = efforts(hand, dof, pressed);
  for (Eigen::Index d = 0; d < effort.size(); ++d)
    if (hand.dofs()[static_cast<std::size_t>(d)].closing == 0) effort[d] = 0;
  const auto told = tip_pressures(hand, at_rest(dof, effort));
  const VectorXd explained = efforts(hand, dof, told);
  const VectorXd friction = 0.05 * model::max_effort(hand);
  for (Eigen::Index d = 0; d < effort.size(); ++d) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(d)];
    if (limits.closing * effort[d] > friction[d]) {
      EXPECT_NEAR(explained[d], effort[d], 0.15 * std::abs(effort[d]) + friction[d]) << limits.name;
    }
  }
  for (std::size_t k = 0; k < told.size(); ++k)
    EXPECT_TRUE(told[k].pressing) << hand.fingertips()[k].name;
}

TEST_P(TipPressures, OfWhatMovesOpensOrRubsAreNone) {
  const model::HandModel& hand = test::hand(GetParam());
  const VectorXd dof = half_closed(hand), most = model::max_effort(hand);
  VectorXd closing(dof.size());
  for (Eigen::Index d = 0; d < dof.size(); ++d)
    closing[d] = hand.dofs()[static_cast<std::size_t>(d)].closing;
  const auto none = [&](const Reading& reading) {
    for (const TipPressure& tip : tip_pressures(hand, reading))
      if (tip.pressing || tip.pressure != 0) return false;
    return true;
  };
  EXPECT_FALSE(none(at_rest(dof, closing.cwiseProduct(most))));
  EXPECT_TRUE(none(at_rest(dof, -closing.cwiseProduct(most))));
  EXPECT_TRUE(none(at_rest(dof, 0.04 * closing.cwiseProduct(most))));
  Reading moving = at_rest(dof, closing.cwiseProduct(most));
  for (Eigen::Index d = 0; d < dof.size(); ++d)
    moving.velocity[d] = model::radian_of(hand.dofs()[static_cast<std::size_t>(d)]);
  EXPECT_TRUE(none(moving));
}

TEST_P(TipPressures, OfARobotThatTellsNoEffortAreNotValid) {
  const model::HandModel& hand = test::hand(GetParam());
  const VectorXd dof = half_closed(hand);
  const auto valid = [&](const VectorXd& effort) {
    std::size_t count = 0;
    for (const auto& pad : touch_to_message(at_rest(dof, effort), hand).pads())
      count += pad.valid() ? 1 : 0;
    return count;
  };
  EXPECT_EQ(valid({}), 0u);
  EXPECT_EQ(valid(VectorXd::Zero(dof.size())), hand.fingertips().size());
}

INSTANTIATE_TEST_SUITE_P(Hands, TipPressures, testing::ValuesIn(test::hand_names()),
                         [](const auto& tested) { return tested.param; });

// Both pads of a gripper press with what its manufacturer calls its force.
TEST(TipPressure, OfBothPadsIsWhatItIsSoldWith) {
  const model::HandModel& hand = test::hand("parallel_jaw");
  const VectorXd dof = half_closed(hand);
  const auto opening = [&](double value) {
    const auto tips = hand.fingertip_positions(VectorXd::Constant(1, value));
    return (tips[0] - tips[1]).norm();
  };
  const double per_unit = std::abs(opening(dof[0] + 1e-4) - opening(dof[0] - 1e-4)) / 2e-4;
  const VectorXd effort = VectorXd::Constant(1, hand.dofs()[0].closing * 15 * per_unit);
  for (const TipPressure& tip : tip_pressures(hand, at_rest(dof, effort)))
    EXPECT_NEAR(tip.pressure, 15, 0.1);
}

}  // namespace
}  // namespace prehend::robot
