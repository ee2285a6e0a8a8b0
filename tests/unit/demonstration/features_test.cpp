#include "services/demonstration/core/recognition/features.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "common/base/random.hpp"
#include "services/demonstration/core/recognition/whitening.hpp"

namespace prehend::demonstration {
namespace {

HandSample random_sample(Random& random) {
  HandSample sample{.t = random.uniform()};
  for (auto& tip : sample.p_thumb_tip_W) tip = random.normal3(0.06);
  for (auto& tip : sample.p_HF) tip = random.normal3(0.06);
  sample.scale = random.uniform(0.8, 1.2);
  sample.hand_speed = random.uniform();
  sample.wrist_speed = random.uniform();
  return sample;
}

TEST(Features, PostureStaysWhenTheHandTurnsAndMirrors) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const HandSample sample = random_sample(random);
    HandSample turned = sample, faster = sample, mirrored = sample;
    const Eigen::Quaterniond q(
        Eigen::AngleAxisd(random.uniform(0, 6), random.normal3(1).normalized()));
    for (auto& tip : turned.p_thumb_tip_W) tip = q * tip;
    for (auto& tip : mirrored.p_thumb_tip_W) tip.y() = -tip.y();
    faster.hand_speed *= 7;
    faster.t += 1;
    const Eigen::VectorXd own = features(sample, Inputs::posture);
    EXPECT_TRUE(own.isApprox(features(turned, Inputs::posture), 1e-9));
    EXPECT_EQ(own, features(faster, Inputs::posture)) << "posture must know nothing of speed";
    EXPECT_TRUE(own.head<10>().isApprox(features(mirrored, Inputs::posture).head<10>(), 1e-9));
    EXPECT_TRUE(
        own.segment<3>(10).isApprox(-features(mirrored, Inputs::posture).segment<3>(10), 1e-9));
  }
}

TEST(Features, MotionStaysWhenTheHandIsLarger) {
  Random random(2);
  const HandSample sample = random_sample(random);
  HandSample larger = sample;
  for (auto& tip : larger.p_thumb_tip_W) tip *= 1.3;
  EXPECT_TRUE(features(sample, Inputs::motion).isApprox(features(larger, Inputs::motion), 1e-9));
  EXPECT_EQ(features(sample, Inputs::both).size(), feature_count(Inputs::both));
}

// What a finger does on the hand is the same for a child and a giant; only the last number, the
// hand's size, tells them apart.
TEST(Features, FingersOnTheHandAreThoseOfAHandOfAverageSize) {
  Random random(6);
  const HandSample sample = random_sample(random);
  HandSample larger = sample;
  for (auto& tip : larger.p_HF) tip *= 1.3;
  larger.scale *= 1.3;
  const Eigen::VectorXd own = features(sample, Inputs::posture),
                        other = features(larger, Inputs::posture);
  EXPECT_TRUE(own.head(own.size() - 1).isApprox(other.head(own.size() - 1), 1e-9));
  EXPECT_NEAR(other.tail<1>()[0], 1.3 * own.tail<1>()[0], 1e-9);
}

// A fingertip a decimetre before its first joint, in the plane of the palm, and then bent by a
// right angle towards it.
TEST(Features, AFingerIsStretchedAndBentAsItStands) {
  Random random(7);
  HandSample sample = random_sample(random);
  sample.scale = 1;
  const Eigen::Vector3d base = model::HumanHand(1).base(model::Finger::index);
  const auto stance = [&](const Eigen::Vector3d& from_base) {
    sample.p_HF[1] = base + from_base;
    return Eigen::Vector3d(features(sample, Inputs::posture).segment<3>(13 + 6 + 3));
  };
  EXPECT_TRUE(stance({0.1, 0, 0}).isApprox(Eigen::Vector3d(0.1, 0, 0), 1e-9));
  EXPECT_TRUE(stance({0, 0, -0.08}).isApprox(Eigen::Vector3d(0.08, std::acos(0.0), 0), 1e-9));
  EXPECT_GT(stance({0.1, 0.03, 0})[2], 0.2) << "spread aside";
}

TEST(Features, ASummaryIsOfWhatCameSoFarAndUnknownNumbersDoNotSpread) {
  Random random(3);
  for (const Inputs inputs : {Inputs::posture, Inputs::motion, Inputs::both}) {
    Summary whole(inputs), holes(inputs);
    const HandSample first = random_sample(random);
    const Eigen::VectorXd begun = whole.add(first);
    ASSERT_EQ(begun.size(), summary_count(inputs));
    const auto n = feature_count(inputs);
    EXPECT_TRUE(begun.head(n).isApprox(features(first, inputs), 1e-12));
    EXPECT_EQ(begun.segment(n, n).norm(), 0) << "nothing has changed yet";
    holes.add(first);
    HandSample hole = first;
    hole.p_thumb_tip_W[2].setConstant(std::nan(""));
    hole.hand_speed = std::nan("");
    EXPECT_TRUE(holes.add(hole).allFinite());
    EXPECT_TRUE(holes.add(random_sample(random)).allFinite());
  }
}

TEST(Features, WhatWasNeverMeasuredCountsAsTheMean) {
  Random random(4);
  Eigen::MatrixXd samples = Eigen::MatrixXd::NullaryExpr(4, 500, [&] { return random.normal(); });
  samples.row(1) = 3 * samples.row(0) + 0.5 * samples.row(1);
  samples(2, 7) = std::nan("");
  const auto scale = Whitening::fit(samples);
  ASSERT_TRUE(scale);
  Eigen::Vector4d x = scale->mean();
  x[3] = std::nan("");
  EXPECT_EQ(scale->apply(x).norm(), 0);
  EXPECT_EQ(scale->apply(Eigen::Vector4d::Constant(1e9)).maxCoeff(), Whitening::farthest);
  EXPECT_FALSE(Whitening::fit(Eigen::MatrixXd(4, 0)));
  EXPECT_EQ(Whitening::fit_within(samples, {0}, 0).error().what, "a class is missing for a sample");
}

// A hand that is seen by more than the recogniser was trained on must not confuse it.
TEST(Features, WhatNobodyMeasuredInTrainingTellsNothing) {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Random(2, 50);
  samples.row(1).setConstant(std::nan(""));
  const auto scale = Whitening::fit(samples);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->apply(Eigen::Vector2d(0, 100))[1], 0, 1e-9);
}

// Within classes, scatter is the unit matrix afterwards, whatever lies between the classes.
TEST(Features, WhiteningEvensTheScatterWithinClasses) {
  Random random(5);
  Eigen::MatrixXd samples(2, 4000);
  std::vector<int> classes;
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    classes.push_back(static_cast<int>(i % 2));
    const double a = random.normal(), b = random.normal(0.2);
    samples.col(i) = Eigen::Vector2d(a + b, a - b) + (i % 2) * Eigen::Vector2d(0, 2);
  }
  const auto scale = Whitening::fit_within(samples, classes, 0);
  ASSERT_TRUE(scale);
  Eigen::Matrix2d within = Eigen::Matrix2d::Zero();
  Eigen::MatrixXd scaled(2, samples.cols());
  for (Eigen::Index i = 0; i < samples.cols(); ++i) scaled.col(i) = scale->apply(samples.col(i));
  Eigen::Matrix2d means = Eigen::Matrix2d::Zero();
  for (Eigen::Index i = 0; i < samples.cols(); ++i) means.col(i % 2) += scaled.col(i) / 2000;
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    const Eigen::Vector2d off = scaled.col(i) - means.col(i % 2);
    within += off * off.transpose() / 4000;
  }
  EXPECT_TRUE(within.isApprox(Eigen::Matrix2d::Identity(), 1e-6)) << within;
}

}  // namespace
}  // namespace prehend::demonstration
