// The mirror in which a left hand is a right one: what a hand does there is what its mirror image
// does here, point by point, for every hand.
#include "services/mapping/core/mirror.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/random.hpp"
#include "tests/support/hands.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;

constexpr double x_W = 0.12;

Vector3d reflected(const Vector3d& p_W) {
  return {2 * x_W - p_W.x(), p_W.y(), p_W.z()};
}

Pose some_pose(Random& random) {
  return make_pose(
      random.normal3(0.3),
      Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(-3, 3), random.normal3(1).normalized())));
}

TEST(Mirror, ShowsEveryHandItsImage) {
  const Mirror mirror(x_W);
  Random random(5);
  for (const std::string& name : model::hand_names()) {
    const model::HandModel& hand = test::hand(name);
    const model::HandModel image = hand.mirrored();
    Command command;
    command.X_WB = some_pose(random);
    command.dof = hand.postures().at("open");
    const Command seen = mirror.command(command);
    const Eigen::VectorXd joint = hand.joint_angles(command.dof);
    const auto X_BL = hand.link_poses(joint), image_X_BL = image.link_poses(joint);
    for (std::size_t f = 0; f < hand.fingertips().size(); ++f) {
      const auto& tip = hand.fingertips()[f];
      const auto link = static_cast<std::size_t>(tip.link);
      const Vector3d p_W = command.X_WB * X_BL[link] * tip.p_LT;
      const Vector3d image_p_W = seen.X_WB * image_X_BL[link] * image.fingertips()[f].p_LT;
      EXPECT_LT((image_p_W - reflected(p_W)).norm(), 1e-9) << name << ' ' << tip.name;
    }
  }
}

TEST(Mirror, TwiceIsTheSameAgain) {
  const Mirror mirror(x_W);
  Random random(6);
  Detection detection;
  detection.X_WO = some_pose(random);
  for (double& value : detection.covariance.reshaped()) value = random.uniform(-1, 1);
  const Detection seen = mirror.detection(detection);
  EXPECT_TRUE(seen.X_WO.translation().isApprox(reflected(detection.X_WO.translation())));
  EXPECT_EQ(seen.covariance(0, 1), -detection.covariance(0, 1));
  EXPECT_EQ(seen.covariance(0, 3), detection.covariance(0, 3));
  EXPECT_EQ(seen.covariance(2, 3), -detection.covariance(2, 3));
  EXPECT_TRUE(mirror.detection(seen).X_WO.isApprox(detection.X_WO));
  EXPECT_EQ(mirror.detection(seen).covariance, detection.covariance);

  RobotState state;
  state.X_WB = some_pose(random);
  EXPECT_TRUE(mirror.state(mirror.state(state)).X_WB.isApprox(state.X_WB));
  EXPECT_NEAR(mirror.state(state).X_WB.linear().determinant(), 1, 1e-12);

  model::GraspCandidates planned;
  planned.candidates.resize(1);
  planned.candidates[0].X_OG = some_pose(random);
  planned.candidates[0].X_OR = some_pose(random);
  // The approach and the hand that takes it stay as they are to each other, seen in the mirror.
  const auto there = mirror.candidates(planned).candidates[0];
  EXPECT_NEAR(
      (there.X_OG.translation() - there.X_OR.translation()).norm(),
      (planned.candidates[0].X_OG.translation() - planned.candidates[0].X_OR.translation()).norm(),
      1e-12);
  EXPECT_TRUE(mirror.candidates(mirror.candidates(planned))
                  .candidates[0]
                  .X_OR.isApprox(planned.candidates[0].X_OR));
}

TEST(Mirror, OfCapsulesIsThatOfTheMirroredHand) {
  const Mirror mirror(x_W);
  const model::HandModel& right = test::hand("barrett");
  const model::HandModel left = right.mirrored();
  const Pose X_WB =
      make_pose({0.1, -0.2, 0.3}, Eigen::Quaterniond(0.9, 0.3, -0.2, 0.1).normalized());
  const Eigen::VectorXd dof = 0.4 * right.postures().at("open") + Eigen::VectorXd::Constant(4, 0.3);
  const auto there = mirror.capsules(HandCapsules(left).at(mirror.pose(X_WB), dof));
  const auto here = HandCapsules(right).at(X_WB, dof);
  ASSERT_EQ(there.size(), here.size());
  // In any order, and with either end first.
  for (const Capsule& one : here)
    EXPECT_TRUE(std::any_of(there.begin(), there.end(), [&](const Capsule& other) {
      const auto is = [&](const Vector3d& end, const Vector3d& far) {
        return (end - one.a).norm() + (far - one.b).norm() < 1e-9;
      };
      return other.radius == one.radius && (is(other.a, other.b) || is(other.b, other.a));
    })) << one.a.transpose();
}

}  // namespace
}  // namespace prehend::mapping
