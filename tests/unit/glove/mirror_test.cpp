// A left hand becomes a right one by the mirror S = I - 2 n nᵀ. What must hold for every frame and
// every mirror: distances stay, rotations stay proper, features p = Rᵀ (x - x_r) change the sign of
// their y (the thumb's side) and nothing else, and the mirror of the mirror image is the frame.
// Tolerance 1e-12: metres and unit quaternions, a dozen roundings.
#include <gtest/gtest.h>

#include <limits>

#include "common/base/random.hpp"
#include "services/glove/core/features.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Frame some_frame(Random& random) {
  Frame frame;
  for (int s = 0; s <= static_cast<int>(Site::forearm); ++s) {
    const Site site = static_cast<Site>(s);
    const Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
    frame.readings.push_back({site, true, random.normal3(0.3), q.normalized()});
  }
  frame.joint_angles = {0.1, 0.2};
  return frame;
}

Pose pose(const Reading& reading) {
  return make_pose(reading.p_TS, reading.q_TS);
}

TEST(Mirror, TurnsHandsIntoTheOtherHand) {
  Random random(5);
  for (int n = 0; n < 200; ++n) {
    const Frame right = some_frame(random);
    const Vector3d normal = random.normal3(1).normalized();
    const Frame left = mirrored(right, normal);
    EXPECT_TRUE(left.left);
    EXPECT_EQ(left.joint_angles, right.joint_angles);
    for (std::size_t s = 0; s < right.readings.size(); ++s) {
      const Reading &a = right.readings[s], &b = left.readings[s];
      EXPECT_NEAR(b.p_TS.norm(), a.p_TS.norm(), 1e-12);
      EXPECT_NEAR(normal.dot(b.p_TS), -normal.dot(a.p_TS), 1e-12);
      EXPECT_NEAR(b.q_TS.norm(), 1, 1e-12);
      const Vector3d feature = invariant_feature(pose(right.readings[0]), a.p_TS);
      const Vector3d other = invariant_feature(pose(left.readings[0]), b.p_TS);
      EXPECT_LT((other - Vector3d(feature.x(), -feature.y(), feature.z())).norm(), 1e-12);
      // Along the finger, and out of its back.
      const auto flip = [&](const Vector3d& v) -> Vector3d {
        return v - 2 * normal.dot(v) * normal;
      };
      EXPECT_LT((b.q_TS * Vector3d::UnitX() - flip(a.q_TS * Vector3d::UnitX())).norm(), 1e-12);
      EXPECT_LT((b.q_TS * Vector3d::UnitZ() - flip(a.q_TS * Vector3d::UnitZ())).norm(), 1e-12);
    }
    const Frame again = mirrored(left, normal);
    EXPECT_FALSE(again.left);
    for (std::size_t s = 0; s < right.readings.size(); ++s) {
      EXPECT_LT((again.readings[s].p_TS - right.readings[s].p_TS).norm(), 1e-12);
      EXPECT_LT(again.readings[s].q_TS.angularDistance(right.readings[s].q_TS), 1e-7);
    }
  }
}

TEST(Mirror, IsAlongTheTablesLeftToRight) {
  const Pose X_WT = make_pose(Vector3d(0, 0.45, 0.3),
                              Quaterniond(Eigen::AngleAxisd(1.2, Vector3d(1, 2, 3).normalized())));
  const Vector3d normal = left_to_right(X_WT);
  EXPECT_LT((X_WT.linear() * normal - Vector3d::UnitX()).norm(), 1e-12);
  Frame frame;
  frame.readings.push_back({Site::back_of_hand, true, X_WT.inverse() * Vector3d(-0.2, 0.1, 0.15)});
  frame = mirrored(frame, normal);
  EXPECT_LT((X_WT * frame.readings[0].p_TS - Vector3d(0.2, 0.1, 0.15)).norm(), 1e-12);
}

// What the core rejects must still look rejectable to it after the mirror.
TEST(Mirror, LeavesWhatIsLostRecognisable) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Frame frame;
  frame.readings.push_back({Site::thumb, true, Vector3d::Zero(), Quaterniond::Identity()});
  frame.readings.push_back({Site::index, true, Vector3d(0.1, 0, 0), Quaterniond(0, 0, 0, 0)});
  frame.readings.push_back({Site::little, true, Vector3d(nan, 0, 0), Quaterniond(1, 0, nan, 0)});
  frame.readings.push_back({Site::ring, false});
  const Frame image = mirrored(frame, Vector3d(1, 2, 2) / 3);
  EXPECT_TRUE(is_identity_pose(image.readings[0]));
  EXPECT_EQ(image.readings[1].q_TS.norm(), 0);
  EXPECT_FALSE(is_identity_pose(image.readings[1]));
  EXPECT_FALSE(image.readings[2].p_TS.allFinite());
  EXPECT_FALSE(image.readings[2].q_TS.coeffs().allFinite());
  EXPECT_FALSE(image.readings[3].valid);
}

}  // namespace
}  // namespace prehend::glove
