// The way to a recording's start: s(u) = 3u² - 2u³ of the distance, u = t / T. Its steepest slope
// is 3/2, so a DoF that moves by d is never faster than 1.5 |d| / T. Checked for all hands and
// random places by differences over a thousandth of the way, which lie on or below the steepest
// slope; the tolerance 1e-9 is rounding.
#include "services/recorder/core/ease_in.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/random.hpp"
#include "tests/support/hands.hpp"

namespace prehend::recorder {
namespace {

std::vector<model::HandModel> hands() {
  std::vector<model::HandModel> all;
  for (const std::string& name : test::hand_names()) all.push_back(test::hand(name));
  return all;
}

HandPlace random_place(const model::HandModel& hand, Random& random) {
  HandPlace place;
  place.dof.resize(static_cast<Eigen::Index>(hand.dofs().size()));
  for (Eigen::Index i = 0; i < place.dof.size(); ++i) place.dof[i] = random.uniform(-1, 1);
  place.X_WB.translation() = random.normal3(0.3);
  place.X_WB.linear() =
      Eigen::AngleAxisd(random.uniform(0, 3), random.normal3(1).normalized()).toRotationMatrix();
  return place;
}

TEST(EaseIn, NoHandIsFasterThanItsLimits) {
  ASSERT_GE(hands().size(), 5u);
  for (const model::HandModel& hand : hands()) {
    Random random(3);
    for (int trial = 0; trial < 20; ++trial) {
      const HandPlace from = random_place(hand, random);
      const HandPlace to = random_place(hand, random);
      const double share = random.uniform(0.1, 1);
      const EaseIn way(hand, from, to, share);
      const double step = to_seconds(way.duration()) / 1000;
      ASSERT_GT(step, 0);
      double fastest = 0;  // of its limit
      HandPlace last = way.at(Duration(0));
      EXPECT_LT((last.dof - from.dof).norm(), 1e-12);
      for (int i = 1; i <= 1000; ++i) {
        const HandPlace here = way.at(seconds(i * step));
        for (Eigen::Index k = 0; k < here.dof.size(); ++k)
          fastest = std::max(fastest, std::abs(here.dof[k] - last.dof[k]) / step /
                                          hand.dofs()[static_cast<std::size_t>(k)].max_velocity);
        const double moved = (here.X_WB.translation() - last.X_WB.translation()).norm() / step;
        EXPECT_LE(moved, 0.25 * share * (1 + 1e-6) + 1e-9);
        EXPECT_LE(angle_between(here.X_WB.linear(), last.X_WB.linear()) / step,
                  0.8 * share * (1 + 1e-4) + 1e-6);
        last = here;
      }
      EXPECT_LE(fastest, share * (1 + 1e-6));
      const HandPlace end = way.at(way.duration()), behind = way.at(2 * way.duration());
      EXPECT_EQ(end.dof, to.dof);
      EXPECT_TRUE(behind.X_WB.isApprox(to.X_WB));
    }
  }
}

TEST(EaseIn, AHandThatIsThereHasNoWay) {
  for (const model::HandModel& hand : hands()) {
    Random random(1);
    const HandPlace place = random_place(hand, random);
    const EaseIn way(hand, place, place);
    EXPECT_LT(to_seconds(way.duration()), 1e-6);
    EXPECT_EQ(way.at(Duration(0)).dof, place.dof);
  }
}

}  // namespace
}  // namespace prehend::recorder
