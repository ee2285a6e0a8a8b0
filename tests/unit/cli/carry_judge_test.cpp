// What came of an object that two hands carried: every way in which it can go wrong is told.
#include "services/cli/service/carry_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace prehend::cli {
namespace {

using Eigen::Vector3d;

struct Way {
  double lift = 0.12, aside = 0.30, tilt = 0;  // m, m, rad
  bool left = true, right = true, sets_down = true;
};

/// Lifted in a second, carried in another, set down in a third, and left alone.
Carried carried(const Way& way) {
  CarryJudge judge(Vector3d(0.3, 0, 0));
  const Vector3d first(-0.1, 0.02, 0.125);
  const auto at = [&](double t, double aside, double up, double tilt) {
    judge.see(make_pose(first + Vector3d(aside, 0, up),
                        Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Vector3d::UnitY()))),
              Time(seconds(1000 + t)));
  };
  judge.feel("left", way.left);
  judge.feel("right", way.right);
  for (double t = 0; t < 1; t += 0.01) at(t, 0, way.lift * t, way.tilt * t);
  for (double t = 0; t < 1; t += 0.01) at(1 + t, way.aside * t, way.lift, way.tilt);
  EXPECT_FALSE(judge.is_over()) << "while it is carried";
  if (!way.sets_down) return judge.carried();
  for (double t = 0; t < 1; t += 0.01) at(2 + t, way.aside, way.lift * (1 - t), way.tilt * (1 - t));
  for (double t = 0; t < 1; t += 0.01) at(3 + t, way.aside, 0, 0);
  EXPECT_FALSE(judge.is_over()) << "while it is held";
  judge.feel("left", false);
  judge.feel("right", false);
  for (double t = 0; t < 1; t += 0.01) at(4 + t, way.aside, 0, 0);
  EXPECT_EQ(judge.is_over(), way.lift > 0.02);
  return judge.carried();
}

TEST(CarryJudge, SaysWhatWasDone) {
  const Carried good = carried({});
  EXPECT_TRUE(good.done(CarryTask::carry));
  EXPECT_NEAR(good.lifted, 0.12, 2e-3);
  EXPECT_NEAR(good.off, 0, 1e-9);
  EXPECT_NEAR(good.both, 1, 1e-9);
  EXPECT_TRUE(carried({.aside = 0.28}).done(CarryTask::carry)) << "2 cm off";
  EXPECT_TRUE(carried({.tilt = 0.15}).done(CarryTask::carry));
}

/// Handed from the left hand to the right one, both holding it in between; or let go of too soon.
Carried handed_over(double left_until, double right_from, bool gives = true, bool falls = false) {
  CarryJudge judge(Vector3d(0.3, 0, 0));
  for (double t = 0; t < 6; t += 0.01) {
    judge.feel("left", t < 4.5 && (gives ? t < left_until : t > left_until));
    judge.feel("right", t < 4.5 && (gives ? t > right_from : t < right_from));
    const double up = std::min({0.12, 0.12 * t, std::max(0.0, 0.12 * (4 - t))});
    const double fallen = falls && t > 4.5 ? 0.12 : 0;
    judge.see(make_pose(Vector3d(std::min(0.3, 0.15 * t), 0, 0.15 + up - fallen)),
              Time(seconds(1000 + t)));
  }
  EXPECT_TRUE(judge.is_over());
  EXPECT_EQ(judge.carried().fell, falls);
  EXPECT_NE(judge.carried().set_down, falls);
  return judge.carried();
}

TEST(CarryJudge, KnowsAHandOver) {
  const Carried good = handed_over(2.0, 1.5);
  EXPECT_TRUE(good.done(CarryTask::hand_over));
  EXPECT_TRUE(good.handed_over);
  EXPECT_NEAR(good.held, 1, 0.01);
  EXPECT_FALSE(good.done(CarryTask::carry)) << "both held it for a short time";
  EXPECT_FALSE(handed_over(1.5, 2.0).done(CarryTask::hand_over)) << "thrown";
  EXPECT_FALSE(handed_over(9, 9).done(CarryTask::hand_over)) << "carried by the left hand alone";
  EXPECT_FALSE(handed_over(1.5, 2.0, false).done(CarryTask::hand_over)) << "the other way";
  EXPECT_FALSE(handed_over(9, 0).done(CarryTask::hand_over)) << "carried by both";
  EXPECT_FALSE(handed_over(3.5, 1.5).done(CarryTask::hand_over)) << "held for half a second";
  EXPECT_TRUE(handed_over(2.0, 1.5, true, true).done(CarryTask::hand_over))
      << "it fell over only when it was let go of on the table";
}

TEST(CarryJudge, TellsEachWayInWhichItGoesWrong) {
  EXPECT_FALSE(carried({.lift = 0.09}).done(CarryTask::carry)) << "too low";
  EXPECT_FALSE(carried({.lift = 0}).done(CarryTask::carry)) << "pushed along";
  EXPECT_FALSE(carried({.aside = 0.26}).done(CarryTask::carry)) << "4 cm off";
  EXPECT_FALSE(carried({.aside = 0}).done(CarryTask::carry)) << "set down where it was";
  EXPECT_FALSE(carried({.tilt = 0.2}).done(CarryTask::carry)) << "tilted by 11 degrees";
  EXPECT_NEAR(carried({.tilt = 0.2}).tilt, 0.2, 1e-6);
  EXPECT_FALSE(carried({.left = false}).done(CarryTask::carry)) << "by one hand";
  EXPECT_EQ(carried({.left = false}).both, 0);
  EXPECT_FALSE(carried({.sets_down = false}).done(CarryTask::carry)) << "still up";
}

}  // namespace
}  // namespace prehend::cli
