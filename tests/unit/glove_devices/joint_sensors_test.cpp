// Joint angles from counts and back, and a person's gains from three poses.
//
// A count is rounded to a whole number, so an angle is off by up to half a gain: 0.0133 rad for the
// coarsest sensor. Gains from two poses one step of counts wrong at either end: relative error
// 1/(counts between them), below 2 % where a finger moves by 60 counts.
#include "services/glove/core/joint_sensors.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/glove/core/fingers_from_tips.hpp"

namespace prehend::glove {
namespace {

using model::HumanHand;
using model::HumanPosture;

/// Somebody whose sensors are unlike the typical ones: gains up to 30 % and zeros up to 20 counts.
JointGains somebody(std::size_t sensors, std::uint64_t seed) {
  Random random(seed);
  JointGains gains = *typical_gains(sensors);
  for (std::size_t s = 0; s < sensors; ++s) {
    gains.gain[s] *= random.uniform(0.9, 1.3);
    gains.offset[s] =
        -gains.gain[s] * (joint_sensors_of(sensors)[s].zero + random.uniform(-20, 20));
  }
  return gains;
}

std::vector<double> rounded(std::vector<double> counts) {
  for (double& count : counts) count = std::round(count);
  return counts;
}

std::vector<std::vector<double>> samples(const HumanPosture& posture, const JointGains& gains,
                                         Random& random) {
  std::vector<std::vector<double>> result;
  for (int n = 0; n < 60; ++n) {
    auto counts = joint_counts(posture, gains);
    for (double& count : counts)
      count = std::clamp(std::round(count + random.normal(0.5)), 1., 255.);
    result.push_back(counts);
  }
  return result;
}

TEST(JointSensors, AreThoseOfBothGloves) {
  EXPECT_EQ(joint_sensors_of(22).size(), 22u);
  EXPECT_EQ(joint_sensors_of(18).size(), 18u);
  EXPECT_EQ(joint_sensors_of(finger_sensors).size(), 5u);
  EXPECT_TRUE(joint_sensors_of(20).empty());
  EXPECT_FALSE(typical_gains(20));
  EXPECT_FALSE(check({}));
  JointGains zero = *typical_gains(18);
  EXPECT_TRUE(check(zero));
  zero.gain[3] = 0;
  EXPECT_FALSE(check(zero));
}

TEST(JointSensors, RoundTripCountsAndAngles) {
  Random random(1);
  for (const std::size_t sensors : {18u, 22u})
    for (int n = 0; n < 200; ++n) {
      const JointGains gains = *typical_gains(sensors);
      std::array<double, 5> closure;
      for (double& c : closure) c = random.uniform();
      HumanPosture truth = HumanHand::posture(closure);
      if (sensors == 18)
        for (const int finger : {0, 4, 8, 12}) truth[finger + 3] = 0.6 * truth[finger + 2];
      truth[4] = 0;  // the middle finger's abduction is not measured
      const HumanPosture got = joint_angles(rounded(joint_counts(truth, gains)), gains);
      EXPECT_LT((got - truth).cwiseAbs().maxCoeff(), 0.0134);
    }
}

// A sensor for each finger: any hand that closes its fingers one by one is read back, also where
// the sensors count down when they close.
TEST(JointSensors, OfFingersTellHowFarEachIsClosed) {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    std::array<double, 5> closure;
    for (double& c : closure) c = random.uniform(0.05, 0.95);
    const HumanPosture truth = HumanHand::posture(closure);
    JointGains gains = *typical_gains(finger_sensors);
    if (n % 2 == 1)
      for (std::size_t s = 0; s < finger_sensors; ++s) {
        gains.offset[s] += 255 * gains.gain[s];
        gains.gain[s] = -gains.gain[s];
      }
    const HumanPosture got = joint_angles(rounded(joint_counts(truth, gains)), gains);
    EXPECT_LT((got - truth).cwiseAbs().maxCoeff(), 0.01);
    const auto fitted = fit_gains(samples(HumanHand::open_posture(), gains, random),
                                  samples(HumanHand::fist_posture(), gains, random),
                                  samples(pinch_posture(), gains, random));
    ASSERT_TRUE(fitted) << fitted.error().message();
    const HumanPosture by_fit = joint_angles(joint_counts(truth, gains), *fitted);
    EXPECT_LT((by_fit - truth).cwiseAbs().maxCoeff(), 0.05);
  }
}

TEST(JointSensors, KeepWhatAHandCanDo) {
  Random random(2);
  for (int n = 0; n < 1000; ++n) {
    std::vector<double> counts(22);
    for (double& count : counts) count = std::floor(random.uniform(1, 256));
    const HumanPosture q = joint_angles(counts, somebody(22, 3));
    ASSERT_TRUE(q.allFinite());
    ASSERT_EQ(q, HumanHand(1).clamp(q));
  }
}

TEST(FitGains, FindsEverybodysGains) {
  for (const std::size_t sensors : {18u, 22u})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Random random(seed);
      const JointGains truth = somebody(sensors, seed);
      const auto fitted = fit_gains(samples(HumanHand::open_posture(), truth, random),
                                    samples(HumanHand::fist_posture(), truth, random),
                                    samples(pinch_posture(), truth, random));
      ASSERT_TRUE(fitted) << fitted.error().message();
      ASSERT_TRUE(check(*fitted));
      // The joint angles of a posture that was not among the three.
      const HumanPosture half = HumanHand::posture({0.5, 0.5, 0.5, 0.5, 0.5});
      const HumanPosture typical = joint_angles(joint_counts(half, truth), *typical_gains(sensors));
      const HumanPosture got = joint_angles(joint_counts(half, truth), *fitted);
      const HumanPosture best = joint_angles(joint_counts(half, truth), truth);
      // Flexion; abduction hardly moves between the poses, so it keeps its typical gain.
      for (const int dof : {1, 2, 5, 6, 9, 10, 13, 14, 18, 19})
        EXPECT_NEAR(got[dof], best[dof], 0.03) << "dof " << dof << " seed " << seed;
      EXPECT_LT((got - best).norm(), (typical - best).norm());
    }
}

TEST(FitGains, SaysWhatIsMissing) {
  Random random(1);
  const JointGains truth = somebody(22, 1);
  const auto open = samples(HumanHand::open_posture(), truth, random);
  const auto fist = samples(HumanHand::fist_posture(), truth, random);
  const auto pinch = samples(pinch_posture(), truth, random);
  EXPECT_FALSE(fit_gains({}, fist, pinch));
  EXPECT_FALSE(fit_gains(open, open, open)) << "nothing moved";
  EXPECT_FALSE(fit_gains(open, {std::vector<double>(18, 1)}, pinch));
  EXPECT_FALSE(fit_gains({{1, 2}}, {{1, 2}}, {{1, 2}}));
}

TEST(PinchPosture, LetsThumbAndIndexTouch) {
  const auto tips = HumanHand(1).fingertip_poses(pinch_posture());
  EXPECT_LT((tips[0].translation() - tips[1].translation()).norm(), 0.003);
}

// The tips of any posture are reached again, though perhaps by another posture.
TEST(FingersFromTips, ReachesThem) {
  Random random(5);
  for (int n = 0; n < 200; ++n) {
    const HumanHand hand(random.uniform(0.8, 1.2));
    std::array<double, 5> closure;
    for (double& c : closure) c = random.uniform();
    const auto tips = hand.fingertip_poses(HumanHand::posture(closure));
    std::array<std::optional<Eigen::Vector3d>, model::finger_count> p_HF;
    for (std::size_t f = 0; f < tips.size(); ++f) p_HF[f] = tips[f].translation();
    const HumanPosture q = fingers_from_tips(hand, p_HF, HumanHand::posture({.5, .5, .5, .5, .5}));
    EXPECT_EQ(q, hand.clamp(q));
    const auto reached = hand.fingertip_poses(q);
    for (std::size_t f = 0; f < tips.size(); ++f)
      EXPECT_LT((reached[f].translation() - tips[f].translation()).norm(), 0.003) << "finger " << f;
  }
}

}  // namespace
}  // namespace prehend::glove
