// After an interruption no hand sweeps to where the operator is now: it follows each motion from
// where it is, and comes there at a set speed. For every hand; postures and places are random.
#include "services/mapping/core/clutch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

Pose any_pose(Random& random) {
  const Eigen::Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1));
  return make_pose({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1)},
                   Eigen::AngleAxisd(random.uniform(0, 3), axis.normalized()).toRotationMatrix());
}

class ClutchTest : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  Eigen::VectorXd any_dof(Random& random) const {
    Eigen::VectorXd dof = hand_.postures().at("open");
    for (std::size_t i = 0; i < hand_.dofs().size(); ++i)
      dof[static_cast<Eigen::Index>(i)] =
          random.uniform(hand_.dofs()[i].lower, hand_.dofs()[i].upper);
    return dof;
  }
};

TEST_P(ClutchTest, IsNothingBeforeItIsHeldAndAfterItHasFaded) {
  Random random(1);
  Clutch clutch(hand_, {});
  const Pose X_WG = any_pose(random), X_WR = any_pose(random);
  const Eigen::VectorXd dof = any_dof(random), robot = any_dof(random);
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(clutch.X_WG(X_WG).matrix(), X_WG.matrix());
    EXPECT_EQ(clutch.dof(dof), dof);
    clutch.hold(X_WG, X_WR);
    clutch.hold(dof, robot);
    EXPECT_TRUE(clutch.X_WG(X_WG).isApprox(X_WR, 1e-9));
    EXPECT_TRUE(clutch.dof(dof).isApprox(robot, 1e-9));
    for (int ms = 0; ms < 60'000; ms += 50) clutch.fade(milliseconds(50));
  }
}

TEST_P(ClutchTest, FollowsEveryMotionAndFadesNoFasterThanItMay) {
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    Clutch clutch(hand_, {});
    Pose X_WG = any_pose(random);
    const Eigen::VectorXd dof = any_dof(random);
    clutch.hold(X_WG, any_pose(random));
    clutch.hold(dof, any_dof(random));
    for (int step = 0; step < 200; ++step) {
      const Pose before = clutch.X_WG(X_WG);
      const Eigen::VectorXd fingers = clutch.dof(dof);
      const Eigen::Vector3d motion(random.uniform(-0.01, 0.01), 0, random.uniform(-0.01, 0.01));
      X_WG.translation() += motion;
      const Duration elapsed = milliseconds(random.index(50));
      const double t = to_seconds(elapsed);
      clutch.fade(elapsed);
      const Pose after = clutch.X_WG(X_WG);
      ASSERT_LE((after.translation() - before.translation() - motion).norm(), 0.1 * t + 1e-9);
      ASSERT_LE(angle_between(after.linear(), before.linear()), 0.5 * t + 1e-6);
      for (std::size_t i = 0; i < hand_.dofs().size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        ASSERT_LE(std::abs(clutch.dof(dof)[k] - fingers[k]),
                  0.5 * radian_of(hand_.dofs()[i]) * t + 1e-9);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mapping, ClutchTest, testing::ValuesIn(test::hand_names()));

/// An operator of all hands before a robot that does what it is told, unless it is stopped.
class Interrupted : public testing::TestWithParam<std::string> {
 protected:
  Interrupted()
      : hand_(test::hand(GetParam())),
        model_(random_model(3, hand_)),
        robot_(hand_.postures().at("open")) {
    mapping_.emplace(*Mapping::create(hand_, model_, {}));
  }
  /// A new one, as a live service starts it.
  void start_slowly() { mapping_.emplace(*Mapping::create(hand_, model_, {.start_slowly = true})); }

  static Time at(int ms) { return Time(std::chrono::seconds(1'700'000'000) + milliseconds(ms)); }
  void robot_says() {
    const auto joints = static_cast<Eigen::Index>(hand_.joints().size());
    ASSERT_TRUE(mapping_->on_state(
        {at(ms_), robot_, Eigen::VectorXd::Zero(joints), Eigen::VectorXd::Zero(joints), base_}));
  }
  /// For so long the operator is at p with fingers closed by c.
  void operate(int duration, const Eigen::Vector3d& p, double c) {
    for (const int end = ms_ + duration; ms_ < end; ms_ += 20) {
      robot_says();
      const Pose X_WG = make_pose(p);
      const Posture posture{at(ms_), at(ms_), X_WG * model::HumanHand(1.0).X_HG().inverse(), 1.0,
                            tips({c, c, c, c, c})};
      const auto command = mapping_->on_posture(posture, at(ms_));
      ASSERT_TRUE(command) << command.error().message();
      watch(*command);
    }
  }
  void pause(int duration) {
    for (const int end = ms_ + duration; ms_ < end; ms_ += 20) {
      robot_says();
      if (const auto command = mapping_->tick(at(ms_))) watch(*command);
    }
  }
  void watch(const Command& command) {
    if (last_) {
      base_step_ =
          std::max(base_step_, (command.X_WB.translation() - last_->X_WB.translation()).norm());
      finger_step_ = std::max(finger_step_, (command.dof - last_->dof).cwiseAbs().maxCoeff());
    }
    last_ = command;
    if (stopped_) return;
    robot_ = command.dof;
    base_ = command.X_WB;
  }
  /// The base's way in 20 ms: 0.1 m/s, and what it turns about the hand with 0.5 rad/s.
  double slow() const { return 0.02 * (0.1 + 0.5 * hand_.X_BG().translation().norm()) + 1e-4; }
  void forget() { base_step_ = finger_step_ = 0; }
  double to_operator(const Eigen::Vector3d& p) const {
    return ((last_->X_WB * hand_.X_BG()).translation() - p).norm();
  }

  const model::HandModel& hand_;
  MappingModel model_;
  std::optional<Mapping> mapping_;
  Eigen::VectorXd robot_;
  Pose base_ = make_pose(Eigen::Vector3d(0, -0.3, 0.4));
  int ms_ = 0;
  bool stopped_ = false;
  std::optional<Command> last_;
  double base_step_ = 0, finger_step_ = 0;  // largest from one command to the next
};

const Eigen::Vector3d here(0.1, 0, 0.3), there(0.6, 0.3, 0.3);

constexpr double slow_finger = 0.02 * 0.51;  // in 20 ms with 0.5 rad/s

TEST_P(Interrupted, AfterAPauseTheHandComesSlowlyAndInTheEnd) {
  operate(3000, here, 0.2);
  ASSERT_LT(to_operator(here), 1e-3);
  pause(500);
  forget();
  operate(1000, there, 0.6);
  EXPECT_LE(base_step_, slow());
  EXPECT_LE(finger_step_, slow_finger);
  EXPECT_GT(to_operator(there), 0.3);
  operate(7000, there, 0.6);
  EXPECT_LE(base_step_, slow());
  EXPECT_LT(to_operator(there), 1e-3);
}

// A hand that has stayed where it was needs no clutch.
TEST_P(Interrupted, APauseAloneChangesNothing) {
  operate(3000, here, 0.2);
  const Command before = *last_;
  pause(1000);
  operate(20, here, 0.2);
  EXPECT_EQ(last_->X_WB.matrix(), before.X_WB.matrix());
  EXPECT_EQ(last_->dof, before.dof);
}

TEST_P(Interrupted, FingersThatChangedInAPauseComeSlowly) {
  operate(3000, here, 0.1);
  const Eigen::VectorXd before = last_->dof;
  pause(500);
  forget();
  operate(20'000, here, 0.9);
  const Eigen::ArrayXd way = (last_->dof - before).array().abs();
  bool far = false;
  for (std::size_t i = 0; i < hand_.dofs().size(); ++i)
    far = far || way[static_cast<Eigen::Index>(i)] > 0.6 * radian_of(hand_.dofs()[i]);
  if (far) {
    EXPECT_LE(finger_step_, slow_finger);
  }
}

TEST_P(Interrupted, AJumpIsNoMotion) {
  operate(3000, here, 0.2);
  forget();
  operate(500, there, 0.2);
  EXPECT_LE(base_step_, slow());
  operate(500, here, 0.2);
  EXPECT_LE(base_step_, slow()) << "and back";
  // A hand that moves is followed.
  forget();
  for (int i = 1; i <= 50; ++i) operate(20, here + 0.01 * i * Eigen::Vector3d::UnitX(), 0.2);
  EXPECT_GT(base_step_, 0.008);
}

TEST_P(Interrupted, WhileItIsStoppedCommandsStayWhereTheHandIs) {
  operate(3000, here, 0.2);
  stopped_ = true;
  mapping_->on_gate(false);
  forget();
  const Pose stopped_at = base_;
  for (int i = 1; i <= 100; ++i) operate(20, here + 0.01 * i * Eigen::Vector3d::UnitX(), 0.2);
  EXPECT_LT((last_->X_WB.translation() - stopped_at.translation()).norm(), 0.051);
  mapping_->on_gate(true);
  stopped_ = false;
  forget();
  operate(1000, here + Eigen::Vector3d::UnitX(), 0.2);
  EXPECT_LE(base_step_, slow() + 0.02 * 0.05);
}

TEST_P(Interrupted, ARobotThatStartsAnewIsMetWhereItIs) {
  operate(3000, here, 0.2);
  ms_ += 2000;  // both are silent
  base_ = make_pose(Eigen::Vector3d(-0.4, -0.4, 0.6));
  robot_ = hand_.postures().at("open");
  robot_says();
  const Pose anew = base_;
  forget();
  last_.reset();
  operate(20, here, 0.2);
  EXPECT_LT((last_->X_WB.translation() - anew.translation()).norm(), slow() + 1e-9);
  operate(1000, here, 0.2);
  EXPECT_LE(base_step_, slow());
  EXPECT_LE(finger_step_, slow_finger);
}

// Nobody was there before: as it always was.
TEST_P(Interrupted, AtTheBeginningItGoesAsFastAsItMay) {
  operate(200, there, 0.2);
  EXPECT_GT(base_step_, 0.019);
}

// A mapping that is new meets a hand that is somewhere already.
TEST_P(Interrupted, AMappingThatStartsAnewMeetsTheHandWhereItIs) {
  start_slowly();
  const auto answers = [&](std::optional<bool> placed) {
    if (placed) mapping_->on_gate(true, placed);
    robot_says();
    const Pose X_WH = make_pose(there) * model::HumanHand(1.0).X_HG().inverse();
    const auto command = mapping_->on_posture(
        {at(ms_), at(ms_), X_WH, 1.0, tips({0.2, 0.2, 0.2, 0.2, 0.2})}, at(ms_));
    ms_ += 20;
    return command.has_value();
  };
  EXPECT_FALSE(answers({})) << "it may be anywhere";
  ASSERT_TRUE(answers(true));
  operate(1000, there, 0.2);
  EXPECT_LE(base_step_, slow());
  EXPECT_LE(finger_step_, slow_finger);
  operate(9000, there, 0.2);
  EXPECT_LT(to_operator(there), 1e-3);
}

// It may be put anywhere: as it always was.
TEST_P(Interrupted, AMappingThatStartsAnewPutsAHandThatIsNowhere) {
  start_slowly();
  mapping_->on_gate(true, false);
  operate(200, there, 0.2);
  EXPECT_GT(base_step_, 0.019);
}

// Of another operator, whose hand is not far from that of the first.
TEST_P(Interrupted, WhoLeadsAnewTakesTheHandAlongSlowly) {
  operate(3000, here, 0.2);
  mapping_->interrupt();
  forget();
  operate(1000, here + 0.15 * Eigen::Vector3d::UnitX(), 0.2);
  EXPECT_LE(base_step_, slow());
}

INSTANTIATE_TEST_SUITE_P(Mapping, Interrupted, testing::ValuesIn(test::hand_names()));

}  // namespace
}  // namespace prehend::mapping
