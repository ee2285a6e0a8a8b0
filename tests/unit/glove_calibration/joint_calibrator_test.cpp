// Gains of a joint-angle glove from three poses that somebody shows: for gloves and people of many
// kinds, the joints between the poses come out right afterwards. Tolerance: sensors tremble by one
// count, about 0.01 rad, the mean over half a second by a tenth of that; at the end of a sensor's
// range counts are cut off, which the people drawn here avoid.
#include "services/glove/core/calibration/joint_calibrator.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace {

using namespace prehend;
using namespace prehend::glove;
using model::HumanPosture;

/// What somebody's glove says, 100 times a second.
struct Person {
  explicit Person(std::size_t sensors, std::uint64_t seed)
      : random(seed), gains(*typical_gains(sensors)) {
    for (std::size_t s = 0; s < sensors; ++s) {
      gains.gain[s] *= random.uniform(0.9, 1.3);
      gains.offset[s] += random.uniform(-0.1, 0.1);
    }
  }

  Frame show(const HumanPosture& posture) {
    Frame frame;
    frame.stamp = from_ns(1'700'000'000'000'000'000 + 10'000'000 * ++count);
    frame.joint_counts = joint_counts(posture, gains);
    for (double& each : frame.joint_counts) each = std::round(each + random.uniform(-1, 1));
    return frame;
  }

  Random random;
  JointGains gains;
  std::int64_t count = 0;
};

const std::array poses{model::HumanHand::open_posture(), model::HumanHand::fist_posture(),
                       pinch_posture()};

TEST(JointCalibrator, JointsAreRightAfterwardsForManyPeopleAndBothGloves) {
  for (const std::size_t sensors : {18u, 22u})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Person person(sensors, seed);
      JointCalibrator calibrator;
      for (std::size_t pose = 0; pose < poses.size(); ++pose) {
        ASSERT_EQ(calibrator.asked(), shown_poses[pose]);
        // On the way nothing is taken.
        const HumanPosture& before = poses[(pose + 2) % 3];
        for (int i = 1; i < 50; ++i) {
          const HumanPosture between = before + i / 50.0 * (poses[pose] - before);
          ASSERT_FALSE(calibrator.see(person.show(between)));
        }
        bool taken = false;
        for (int i = 0; i < 200 && !taken; ++i)
          taken = calibrator.see(person.show(poses[pose])).has_value();
        ASSERT_TRUE(taken) << calibrator.waiting_for();
      }
      ASSERT_FALSE(calibrator.asked());
      const auto gains = calibrator.result();
      ASSERT_TRUE(gains) << gains.error().message();
      // Half way to the fist: fingers' flexions, which the three poses move.
      const HumanPosture half = 0.5 * (poses[0] + poses[1]);
      const HumanPosture seen = joint_angles(joint_counts(half, person.gains), *gains);
      for (int finger = 0; finger < 4; ++finger)
        for (int joint = 1; joint <= 2; ++joint)
          EXPECT_NEAR(seen[4 * finger + joint], half[4 * finger + joint], 0.06)
              << sensors << " sensors, person " << seed << ", finger " << finger;
    }
}

TEST(JointCalibrator, AskedAgainAndWithoutJointsItWaits) {
  Person person(22, 3);
  JointCalibrator calibrator;
  const auto hold = [&](const HumanPosture& posture) {
    for (int i = 0; i < 200; ++i)
      if (calibrator.see(person.show(posture))) return true;
    return false;
  };
  EXPECT_FALSE(calibrator.redo());
  ASSERT_TRUE(hold(poses[0]));
  EXPECT_FALSE(hold(poses[0])) << "the same pose is no fist";
  EXPECT_EQ(calibrator.waiting_for(), "move on to the next one");
  ASSERT_TRUE(hold(poses[1]));
  ASSERT_TRUE(calibrator.redo());
  EXPECT_EQ(calibrator.asked(), ShownPose::fist);
  EXPECT_FALSE(calibrator.result());
  Frame other;
  EXPECT_FALSE(calibrator.see(other));
  EXPECT_EQ(calibrator.waiting_for(), "the glove sends no joints");
}

}  // namespace
