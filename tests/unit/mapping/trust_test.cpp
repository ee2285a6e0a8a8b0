// A measurement of standard deviation σ beside a tolerance τ counts min(1, (τ/σ)²): its share where
// both are weighed by their inverse variances. Tolerances: 1e-12 for a division and a product; 1e-9
// of what is compared where an eigenvalue is found by iteration.
#include "services/mapping/core/trust.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.hpp"
#include "services/mapping/core/ramp.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

ObjectTrack seen(model::ShapeKind kind, const Eigen::Vector4d& deviations, double size_deviation) {
  ObjectTrack track;
  track.detection.shape = {kind, {0.04, 0.04, 0.1}};
  track.detection.covariance = deviations.cwiseAbs2().asDiagonal();
  track.size = 0.04;
  track.size_variance = size_deviation * size_deviation;
  return track;
}

double expected(double tolerance, double deviation) {
  return std::min(1.0, std::pow(tolerance / deviation, 2));
}

TEST(Reliability, IsTheLeastShareOfPositionTurnAndSize) {
  const TrustOptions options;
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double position = random.uniform(1e-4, 0.05), turn = random.uniform(1e-3, 1);
    const double size = random.uniform(1e-5, 0.04);
    const double by_size = expected(options.sure_size * 0.04, size);
    const double by_position = expected(options.sure_position, position);
    const Eigen::Vector4d deviations(position, 0.5 * position, 0.1 * position, turn);
    const double round = std::min(by_position, by_size);
    // A turned cylinder is the same cylinder, a turned box is not the same box.
    EXPECT_NEAR(reliability(seen(model::ShapeKind::cylinder, deviations, size), options), round,
                1e-9 * round);
    const double box = std::min(round, expected(options.sure_turn, turn));
    EXPECT_NEAR(reliability(seen(model::ShapeKind::box, deviations, size), options), box,
                1e-9 * box);
  }
}

TEST(Reliability, OfWhatIsExactIsOne) {
  for (const auto kind :
       {model::ShapeKind::cylinder, model::ShapeKind::box, model::ShapeKind::sphere})
    EXPECT_EQ(reliability(seen(kind, Eigen::Vector4d::Zero(), 0), {}), 1);
}

// The largest deviation in any direction counts, so turning the room changes nothing.
TEST(Reliability, DoesNotDependOnTheAxesOfTheRoom) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    ObjectTrack track =
        seen(model::ShapeKind::cylinder, {0.03, random.uniform(0, 0.03), 0.001, 0}, 0);
    const double before = reliability(track, {});
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(random.uniform(-3, 3), random.normal3(1).normalized()).matrix();
    auto position = track.detection.covariance.topLeftCorner<3, 3>();
    position = (R * position * R.transpose()).eval();
    EXPECT_NEAR(reliability(track, {}), before, 1e-9 * before);
  }
}

TEST(Ramp, ReachesItsGoalAtAConstantRateAndNoFaster) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Ramp ramp(milliseconds(300));
    double goal = random.uniform();
    for (int step = 0; step < 50; ++step) {
      if (random.uniform() < 0.1) goal = random.uniform();
      const int ms = static_cast<int>(random.index(40));
      const double before = ramp.value();
      ramp.follow(goal, milliseconds(ms));
      const double way = std::min(std::abs(goal - before), ms / 300.0);
      EXPECT_NEAR(std::abs(ramp.value() - before), way, 1e-12);
      EXPECT_LE(std::abs(goal - ramp.value()), std::abs(goal - before));
    }
    ramp.reset();
    EXPECT_EQ(ramp.value(), 0);
  }
}

TEST(Trust, FollowsWhatIsSeenAndKeepsWhatIsGrippedOrLost) {
  const ObjectTrack sure = seen(model::ShapeKind::cylinder, Eigen::Vector4d::Zero(), 0);
  const ObjectTrack unsure = seen(model::ShapeKind::cylinder, {0.02, 0.02, 0.02, 0}, 0);
  Trust trust({}, milliseconds(300));
  trust.step(&sure, Phase::engaging, milliseconds(150));
  EXPECT_NEAR(trust.bound(), 0.5, 1e-12);
  trust.step(&sure, Phase::engaged, milliseconds(400));
  EXPECT_EQ(trust.bound(), 1);
  trust.step(nullptr, Phase::leaving, milliseconds(400));
  EXPECT_EQ(trust.bound(), 1) << "lost";
  trust.step(&unsure, Phase::gripping, milliseconds(400));
  EXPECT_EQ(trust.bound(), 1) << "gripped: the hand hides what it grips";
  trust.step(&unsure, Phase::engaging, milliseconds(60));
  EXPECT_NEAR(trust.bound(), 0.8, 1e-12) << "no jump";
  trust.step(&unsure, Phase::engaged, milliseconds(1000));
  EXPECT_NEAR(trust.bound(), 0.25, 1e-9);
  trust.step(nullptr, Phase::direct, milliseconds(10));
  EXPECT_EQ(trust.bound(), 0) << "no object";
}

}  // namespace
}  // namespace prehend::mapping
