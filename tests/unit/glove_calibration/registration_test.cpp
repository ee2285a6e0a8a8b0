// Rigid registration: with exact points the pose comes back to rounding (1e-9); with noise sigma on
// n points the pose's error stays within what least squares leaves: the centre is sigma/sqrt(n) a
// coordinate, the rotation about sigma over the lever of the points. Five of these is the
// tolerance.
#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/glove/core/calibration/toucher.hpp"

namespace prehend::glove {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

const Points corners{{-0.2, -0.15, 0}, {0.2, -0.15, 0}, {0.2, 0.15, 0}, {-0.2, 0.15, 0}};

Pose some_pose(Random& random) {
  const Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return make_pose(random.normal3(0.5), q.normalized());
}

Points seen_from(const Pose& X_WT, const Points& p_W) {
  Points p_T;
  for (const Vector3d& p : p_W) p_T.push_back(X_WT.inverse() * p);
  return p_T;
}

TEST(Registration, FindsEveryPose) {
  Random random(2);
  for (int n = 0; n < 300; ++n) {
    const Pose X_WT = some_pose(random);
    Points p_W = corners;
    if (n % 2 == 1)  // any three points or more that span an area
      for (Vector3d& p : p_W) p = random.normal3(0.2);
    if (n % 3 == 0) p_W.pop_back();
    const auto found = register_tracker(p_W, seen_from(X_WT, p_W));
    if (!found) continue;  // drawn on a line
    EXPECT_TRUE(found->X_WT.isApprox(X_WT, 1e-9)) << n;
    EXPECT_NEAR(found->X_WT.linear().determinant(), 1, 1e-9);
    EXPECT_LT(found->residual, 1e-9);
  }
}

TEST(Registration, StandsNoise) {
  Random random(3);
  constexpr double sigma = 0.0015;
  double residuals = 0;
  constexpr int rounds = 300;
  for (int n = 0; n < rounds; ++n) {
    const Pose X_WT = some_pose(random);
    Points p_T = seen_from(X_WT, corners);
    for (Vector3d& p : p_T) p += random.normal3(sigma);
    const auto found = register_tracker(corners, p_T);
    ASSERT_TRUE(found);
    // In the middle of the table, where the hand works.
    const Vector3d centre = found->X_WT * (X_WT.inverse() * Vector3d::Zero());
    EXPECT_LT(centre.norm(), 5 * sigma / 2 * std::sqrt(3.0));
    EXPECT_LT(angle_between(found->X_WT.linear(), X_WT.linear()), 5 * sigma / 0.15);
    EXPECT_GE(found->worst, found->residual);
    residuals += found->residual / rounds;
  }
  // 12 coordinates less 6 of the pose leave half of the squares.
  EXPECT_NEAR(residuals, sigma * std::sqrt(3.0 / 2), 0.2 * sigma);
}

TEST(Registration, RefusesWhatDeterminesNothing) {
  const Points line{{0, 0, 0}, {0.1, 0, 0}, {0.2, 0.001, 0}, {0.3, 0, 0}};
  EXPECT_FALSE(register_tracker(line, line));
  EXPECT_FALSE(register_tracker(Points(4, Vector3d(1, 2, 3)), Points(4, Vector3d(1, 2, 3))));
  EXPECT_FALSE(register_tracker({}, {}));
  EXPECT_FALSE(register_tracker(corners, Points(corners.begin(), corners.end() - 1)));
  Points bad = corners;
  bad[1].x() = NAN;
  EXPECT_FALSE(register_tracker(corners, bad));
  // Another figure: two points exchanged, which no rigid motion explains.
  Points exchanged = corners;
  std::swap(exchanged[0], exchanged[1]);
  std::swap(exchanged[1], exchanged[2]);
  EXPECT_FALSE(register_tracker(corners, exchanged));
}

TEST(Registration, IsWrittenIntoTheConfiguration) {
  const std::string line = x_wt_line(make_pose(Vector3d(0, 0.45, 0.3)));
  EXPECT_EQ(line, "X_WT = [0.00000, 0.45000, 0.30000, 1.000000, 0.000000, 0.000000, 0.000000]");
}

TEST(Toucher, HasNoResultBeforeAllPointsWereTouched) {
  EXPECT_EQ(Toucher(corners).result().error().message(),
            "registration: 0 of 4 points were touched (no frames yet)");
}

// From frames to the pose: a hand goes from corner to corner and rests at each.
TEST(Toucher, FindsTheTrackerFromFrames) {
  Random random(11);
  for (int n = 0; n < 20; ++n) {
    const Pose X_WT = some_pose(random);
    const Vector3d p_HF(0.14, 0.03, -0.03);
    Toucher toucher(corners);
    double time = 0;
    int taken = 0;
    Vector3d from(0, 0, 0.2);
    const auto at = [&](const Vector3d& p_WF) {
      const Pose X_TH = X_WT.inverse() * make_pose(p_WF - p_HF);
      Frame frame;
      frame.stamp = Time(seconds(time));
      frame.readings.push_back({Site::back_of_hand, true,
                                X_TH.translation() + random.normal3(0.0005),
                                Quaterniond(X_TH.linear())});
      frame.readings.push_back(
          {Site::index, true, X_TH * p_HF + random.normal3(0.0005), Quaterniond(X_TH.linear())});
      taken += toucher.see(frame).has_value();
      time += 1 / 30.;
    };
    for (const Vector3d& corner : corners) {
      for (int k = 0; k < 30; ++k) at(from + k / 30. * (corner - from));
      for (int k = 0; k < 45; ++k) at(corner);
      from = corner;
    }
    EXPECT_EQ(taken, 4);
    const auto found = toucher.result();
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_LT((found->X_WT * (X_WT.inverse() * Vector3d::Zero())).norm(), 0.002);
  }
}

}  // namespace
}  // namespace prehend::glove
