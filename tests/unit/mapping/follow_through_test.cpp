// Fingers that have closed on a known object go on until they are stopped. For every hand: only in
// the closing direction, in proportion, within the limits and no faster than they may; what the
// operator opens is opened at once; a hand that lifts what it holds goes on holding it.
#include "services/mapping/core/follow_through.hpp"

#include <gtest/gtest.h>

#include "services/mapping/core/grip_controller.hpp"
#include "tests/support/hands.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using std::chrono::milliseconds;

constexpr auto frame_period = milliseconds(33);

class Following : public testing::TestWithParam<std::string> {
 protected:
  /// Some share of the way from the open hand to the ends of what closes.
  VectorXd closed(double share) const {
    VectorXd dof = hand.postures().at("open");
    for (Index i = 0; i < dof.size(); ++i) {
      const model::HandDof& d = hand.dofs()[static_cast<std::size_t>(i)];
      if (d.closing == 0) continue;
      dof[i] += share * ((d.closing > 0 ? d.upper : d.lower) - dof[i]);
    }
    return dof;
  }
  /// The farthest that a DoF has gone on, rad.
  double gone_on(const VectorXd& from, const VectorXd& to) const {
    double most = 0;
    for (Index i = 0; i < from.size(); ++i) {
      const model::HandDof& d = hand.dofs()[static_cast<std::size_t>(i)];
      const double by = (to[i] - from[i]) / radian_of(d);
      EXPECT_GE(d.closing * by, d.closing == 0 ? 0 : -1e-12) << d.name;
      if (d.closing == 0) {
        EXPECT_EQ(by, 0) << d.name;
      }
      most = std::max(most, std::abs(by));
    }
    return most;
  }
  VectorXd go_on(double share, bool is_closed, bool touching, int frames) {
    VectorXd result;
    for (int i = 0; i < frames; ++i)
      result = following.go_on(closed(share), is_closed, touching, frame_period);
    return result;
  }

  const model::HandModel& hand = test::hand(GetParam());
  FollowThroughOptions options;
  FollowThrough following{hand};
};

TEST_P(Following, LeavesAloneWhatHasNotClosedOnAnything) {
  EXPECT_EQ(go_on(0.5, false, false, 50), closed(0.5));
  EXPECT_EQ(go_on(0.5, false, true, 50), closed(0.5));
}

TEST_P(Following, GoesOnUntilTheMostAtItsSpeed) {
  const VectorXd from = closed(0.4);
  double before = 0;
  for (int i = 0; i < 60; ++i) {
    const VectorXd to = following.go_on(from, true, false, frame_period);
    EXPECT_EQ(hand.clamp(to), to);
    const double now = gone_on(from, to);
    EXPECT_GE(now, before - 1e-12);
    EXPECT_LE(now - before, options.speed * 0.033 + 1e-9);
    before = now;
  }
  EXPECT_LE(before, model::full_follow_through + 1e-9);
  EXPECT_GT(before, 0.01);
}

// So that all arrive together: what has come twice as far goes on twice as far.
TEST_P(Following, GoesOnInProportion) {
  const VectorXd open = hand.postures().at("open"), from = closed(0.3);
  const VectorXd to = go_on(0.3, true, false, 2);
  double ratio = 0;
  for (Index i = 0; i < from.size(); ++i) {
    const double way = from[i] - open[i];
    if (hand.dofs()[static_cast<std::size_t>(i)].closing == 0 || std::abs(way) < 1e-6) continue;
    if (ratio == 0) ratio = (to[i] - from[i]) / way;
    EXPECT_NEAR((to[i] - from[i]) / way, ratio, 1e-9) << i;
  }
  EXPECT_GT(ratio, 0);
}

TEST_P(Following, OpensAtOnceWithTheOperator) {
  go_on(0.6, true, true, 40);
  EXPECT_EQ(following.go_on(closed(0.3), false, true, frame_period), closed(0.3));
}

TEST_P(Following, HoldsWhatItLifts) {
  const VectorXd held = go_on(0.5, true, true, 60);
  EXPECT_EQ(go_on(0.5, false, true, 60), held);
  EXPECT_EQ(go_on(0.5, false, false, 1), closed(0.5)) << "it has fallen";
}

INSTANTIATE_TEST_SUITE_P(All, Following, testing::ValuesIn(test::hand_names()));

}  // namespace
}  // namespace prehend::mapping
