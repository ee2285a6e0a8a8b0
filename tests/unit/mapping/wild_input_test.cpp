// A wild operator, a camera that loses and invents objects and is unsure of them, a robot that is
// stopped here and there, and modes that change at any moment: for every hand, whatever its
// networks answer, each command keeps the limits relative to the one before. Exact up to rounding:
// 1e-12 for sums of a few numbers, 1e-7 for an angle near 0, which is the arc cosine of nearly 1.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <tuple>
#include <vector>

#include "common/convert/convert.hpp"
#include "common/model/placement.hpp"
#include "services/mapping/service/messages.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

TEST(MappingMessages, PosesThatAreNoneAreRefused) {
  v1::HandPosture posture;
  posture.X_WH(convert::to_message(make_pose({0, 0, 0.2})));
  EXPECT_TRUE(posture_from_message(posture));
  posture.X_WH().position().z(std::nan(""));
  EXPECT_EQ(posture_from_message(posture).error().what, "pose of the hand not usable");
  v1::HandState state;
  state.X_WB(convert::to_message(make_pose({0, 0, 0.2})));
  EXPECT_TRUE(state_from_message(state));
  state.X_WB().orientation().w(0);
  EXPECT_EQ(state_from_message(state).error().what, "pose of the robot not usable");
}

class WildInput : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(WildInput, NeverMovesFasterThanTheLimits) {
  const model::HandModel& hand = test::hand(std::get<0>(GetParam()));
  const auto seed = static_cast<std::uint64_t>(std::get<1>(GetParam()));
  Random random(seed);
  const MappingModel model = random_model(seed, hand);
  Mapping mapping = *Mapping::create(hand, model, {});
  const model::Shape thin{model::ShapeKind::cylinder, {0.015, 0.015, 0.145}};
  const model::Shape box{model::ShapeKind::box, {0.04, 0.12, 0.20}};
  Eigen::Matrix3d from_the_side;
  from_the_side << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const Pose X_WG_near = make_pose(Eigen::Vector3d(0, 0, 0.10), from_the_side);
  const auto joints = static_cast<Eigen::Index>(hand.joints().size());
  Eigen::VectorXd robot = hand.postures().at("open");
  Pose base = make_pose(Eigen::Vector3d(0.5, 0.5, 0.5));
  std::optional<Command> before;
  int ms = 0, intelligent = 0, holds = 0, grips = 0;
  const auto at = [](int t) { return Time(std::chrono::seconds(1'700'000'000) + milliseconds(t)); };
  Time commanded{};
  for (int step = 0; step < 2000; ++step) {
    ms += 1 + static_cast<int>(random.index(40));
    const bool silent = random.uniform() < 0.03;
    if (silent) ms += 100;
    if (random.uniform() < 0.02) {
      const auto fingers = static_cast<FingerMode>(random.index(4));
      ASSERT_TRUE(mapping.use({fingers, random.uniform() < 0.8, random.uniform() < 0.8}));
    }
    if (random.uniform() < 0.4) {
      const model::Shape& shape = random.uniform() < 0.5 ? thin : box;
      const Pose X_WO = make_pose(
          {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), half_extents(shape).z()});
      const auto track = static_cast<std::uint32_t>(random.index(3));
      Detection seen{track, "object " + std::to_string(track), shape, X_WO, 0.95, at(ms)};
      seen.shape.size *= random.uniform(0.8, 1.2);
      if (random.uniform() < 0.3)
        seen.covariance.diagonal().setConstant(std::pow(random.uniform(0, 0.1), 2));
      (void)mapping.on_detection(seen);
    }
    if (random.uniform() < 0.02)
      mapping.on_detection_gone(static_cast<std::uint32_t>(random.index(3)));
    if (before) {
      // The robot follows, but stops on its way in phases: so early that slow fingers are told to
      // go on, too.
      robot = before->dof;
      if ((step / 400) % 2 == 1)
        for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
          const model::HandDof& dof = hand.dofs()[i];
          const double way = 0.25 * (dof.upper - dof.lower);
          double& q = robot[static_cast<Eigen::Index>(i)];
          if (dof.closing != 0)
            q = dof.closing > 0 ? std::min(q, dof.lower + way) : std::max(q, dof.upper - way);
        }
      base = before->X_WB;
    }
    const RobotState state{at(ms), robot, Eigen::VectorXd::Zero(joints),
                           Eigen::VectorXd::Zero(joints), base};
    ASSERT_TRUE(mapping.on_state(state));
    // Mostly near the objects, at times anywhere.
    const double far = random.uniform() < 0.1 ? 2.0 : 0.1;
    Pose X_WG = X_WG_near;
    X_WG.translation() += Eigen::Vector3d(random.uniform(-far, far), random.uniform(-far, far),
                                          random.uniform(0, far));
    const double c = random.uniform();
    const Time stamp = at(ms - static_cast<int>(random.index(20)));
    Posture posture{stamp, stamp, X_WG * model::HumanHand(1.0).X_HG().inverse(), 1.0,
                    tips({c, c, c, c, c})};
    if (silent || random.uniform() < 0.05) posture.fingertips[1].valid = false;
    std::optional<Command> command;
    if (const auto answer = mapping.on_posture(posture, at(ms)))
      command = *answer;
    else
      command = mapping.tick(at(ms));
    if (!command) continue;
    holds += command->mode == Mode::hold;
    intelligent += command->mode == Mode::intelligent;
    grips += mapping.phase() == Phase::gripping;
    ASSERT_TRUE(command->dof.allFinite() && is_finite(command->X_WB));
    ASSERT_TRUE(hand.clamp(command->dof).isApprox(command->dof, 1e-12));
    if (before) {
      const double t = std::min(0.1, std::max(0.0, to_seconds(command->stamp - commanded)));
      for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        ASSERT_LE(std::abs(command->dof[k] - before->dof[k]),
                  hand.dofs()[i].max_velocity * t + 1e-12);
      }
      ASSERT_LE((command->X_WB.translation() - before->X_WB.translation()).norm(), 1.0 * t + 1e-9);
      ASSERT_LE(angle_between(command->X_WB.linear(), before->X_WB.linear()), 3.0 * t + 1e-7);
      ASSERT_LE(std::abs(command->weight - before->weight), t / 0.3 + 1e-9);
    }
    commanded = std::max(commanded, command->stamp);
    before = command;
  }
  EXPECT_GT(holds, 10);
  EXPECT_GT(intelligent, 50);
  EXPECT_GT(grips, 5);
}

INSTANTIATE_TEST_SUITE_P(Mapping, WildInput,
                         testing::Combine(testing::ValuesIn(test::hand_names()),
                                          testing::Range(1, 4)));

}  // namespace
}  // namespace prehend::mapping
