// The driver of Robotiq's grippers against emulated ones, in computed time.
#include "services/robot/core/robotiq_driver.hpp"

#include <gtest/gtest.h>

#include "services/robot/core/robotiq_emulator.hpp"
#include "tests/unit/robot/computed_wire.hpp"
#include "tests/unit/robot/hand_of_twelve.hpp"

namespace prehend::robot::robotiq {
namespace {

const model::HandModel& gripper(const Kind& kind) {
  static const auto small = model::HandModel::load(model::hand_directory("robotiq_2f85"));
  static const auto large = model::HandModel::load(model::hand_directory("robotiq_2f140"));
  return kind.name == kind_2f85.name ? *small : *large;
}

Eigen::VectorXd at(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

struct Wire : ComputedWire<Emulator, Driver> {
  explicit Wire(const EmulatedOptions& options = {.initialized = true},
                const Kind& kind = kind_2f85)
      : ComputedWire(Emulator(gripper(kind), kind, options),
                     Driver(gripper(kind), {.baud = 115200}, kind)) {
    hear = [this](const std::string& said) {
      modbus::Parser parser(modbus::Side::asks);
      parser.feed(said);
      while (const auto frame = parser.next()) {
        if (frame->function != static_cast<std::uint8_t>(modbus::Function::write)) continue;
        modbus::Registers registers;
        for (std::size_t i = 0; i < register_count; ++i)
          registers.push_back(modbus::word(frame->data, 5 + 2 * i));
        told.push_back(action_of(registers));
      }
    };
  }
  double where() const { return robot.measured()[0]; }

  std::vector<Action> told;
};

/// One that something holds fast, as another's finger between its own.
void hold_fast(Wire& wire, double dof) {
  wire.robot.measure(at(dof));
}

TEST(RobotiqDriver, AnActivatedOneIsReadyWithoutAMove) {
  Wire wire;
  const double before = wire.where();
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_EQ(wire.where(), before);
  EXPECT_EQ(wire.driver.identity(), "Robotiq 2F-85, id 9");
  for (const Action& action : wire.told) EXPECT_EQ(action.bits, active) << "it may not go";
}

TEST(RobotiqDriver, OneThatIsNotActivatedSaysWhatThatWillDoAndWaits) {
  Wire wire{EmulatedOptions{}};
  wire.tell = at(0.5);
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::configured);
  EXPECT_EQ(wire.driver.trouble(),
            "it is not activated (activating it opens and closes its fingers fully)");
  EXPECT_TRUE(wire.told.empty());
  EXPECT_FALSE(wire.driver.reading()) << "it does not know where its fingers are";
}

TEST(RobotiqDriver, HomingActivatesIt) {
  Wire wire{EmulatedOptions{}};
  wire.run(0.5);
  wire.driver.home();
  double farthest = 0;
  for (int n = 0; n < 1000 && wire.driver.phase() != Phase::ready; ++n) {
    wire.run(0.01);
    EXPECT_NE(wire.driver.phase(), Phase::faulted) << wire.driver.trouble();
    farthest = std::max(farthest, wire.where());
  }
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
  EXPECT_GT(farthest, 0.75) << "it closes fully";
  EXPECT_LT(wire.where(), 0.05);
  ASSERT_GE(wire.told.size(), 2u);
  EXPECT_EQ(wire.told[0].bits, 0) << "only an edge activates it";
}

TEST(RobotiqDriver, AHoldEndsItsActivation) {
  Wire wire{EmulatedOptions{}};
  wire.run(0.5);
  wire.driver.home();
  wire.run(0.6);
  wire.driver.hold();
  wire.run(0.2);
  EXPECT_EQ(wire.driver.phase(), Phase::configured);
  const double where = wire.where();
  wire.run(3);
  EXPECT_EQ(wire.where(), where);
}

class Grippers : public testing::TestWithParam<const Kind*> {};

TEST_P(Grippers, FollowWhatTheyAreTold) {
  Wire wire({.initialized = true}, *GetParam());
  wire.run(0.5);
  for (const double goal : {0.4, 0.1, 0.77}) {
    wire.tell = at(goal);
    wire.run(1.5);
    ASSERT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
    EXPECT_NEAR(wire.where(), goal, 0.008);
    EXPECT_NEAR(wire.driver.reading()->dof[0], goal, 0.008);
    EXPECT_NEAR(wire.driver.reading()->velocity[0], 0, 0.01);
    EXPECT_EQ(wire.driver.reading()->effort[0], 0);
  }
  EXPECT_EQ(wire.rejects, 0u);
}

// The effort is a force: what the motor does along its DoF, both pads do along the opening.
TEST_P(Grippers, CloseWithTheForceThatTheyAreAllowed) {
  const Kind& kind = *GetParam();
  Wire wire({.initialized = true}, kind);
  wire.run(0.5);
  for (const double force : {30.0, 45.0}) {
    const double effort = force * kind.opening / 0.8;
    wire.driver.follow(at(0.5), at(effort), wire.now());
    wire.run(0.5);
    const double told =
        kind.min_force + (kind.max_force - kind.min_force) * wire.told.back().force / 255;
    EXPECT_NEAR(told, force, 1);
  }
  // Force 0 is the least that it can, not none.
  wire.driver.follow(at(0.5), at(0), wire.now());
  wire.run(0.5);
  EXPECT_EQ(wire.told.back().force, 0);
}

INSTANTIATE_TEST_SUITE_P(All, Grippers, testing::Values(&kind_2f85, &kind_2f140),
                         [](const auto& kind) { return std::string(kind.param->name); });

TEST(RobotiqDriver, WhatItHoldsItTellsAndKeepsHolding) {
  Wire wire;
  wire.run(0.5);
  hold_fast(wire, 0.3);
  wire.driver.follow(at(0.6), at(4), wire.now());
  wire.run(1);
  EXPECT_NEAR(wire.driver.reading()->effort[0], 4, 0.2);
  EXPECT_GT(wire.robot.driven()[0], 0.32) << "it presses";
  // Neither a hold, a farewell nor a lost wire lets it go; and that is no joint that is stuck.
  wire.driver.hold();
  EXPECT_EQ(wire.driver.farewell(), "");
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  wire.cut = true;
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.cut = false;
  wire.run(1.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_GT(wire.robot.driven()[0], 0.32);
  wire.driver.follow(at(0.1), {}, wire.now());
  wire.run(0.2);
  EXPECT_LT(wire.robot.driven()[0], 0.3) << "told to open, it does";
}

TEST(RobotiqDriver, HoldsStillWhereItIs) {
  Wire wire;
  wire.run(0.5);
  wire.tell = at(0.75);
  wire.run(0.2);
  wire.tell.reset();
  wire.driver.hold();
  const double where = wire.where();
  EXPECT_LT(where, 0.5);
  wire.run(1);
  EXPECT_LT(wire.where() - where, 0.06);
}

TEST(RobotiqDriver, AFarewellStopsIt) {
  Wire wire;
  wire.run(0.5);
  wire.tell = at(0.75);
  wire.run(0.2);
  wire.robot.receive(wire.driver.farewell(), wire.passed());
  const double where = wire.where();
  wire.robot.pass(wire.passed() + std::chrono::seconds(2));
  EXPECT_EQ(wire.where(), where);
}

TEST(RobotiqDriver, AfterALostWireItStaysUntilItIsTold) {
  Wire wire;
  wire.run(0.5);
  wire.tell = at(0.7);
  wire.run(0.1);
  wire.cut = true;
  wire.tell.reset();
  wire.run(2);
  EXPECT_EQ(wire.first_trouble, "the wire is lost");
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.robot.receive(
      modbus::encode(modbus::write(9, action_at, encode(Action{active | goes, 20, 0, 0}))),
      wire.passed());  // somebody has sent it elsewhere meanwhile
  wire.run(0.1);
  wire.cut = false;
  wire.run(0.7);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  const double where = wire.where();
  EXPECT_GT(where, 0.1);
  wire.run(1);
  EXPECT_EQ(wire.where(), where);
  wire.tell = at(0.2);
  wire.run(1.5);
  EXPECT_NEAR(wire.where(), 0.2, 0.008);
}

TEST(RobotiqDriver, ALostActivationIsNamedAndNeedsHoming) {
  Wire wire;
  wire.run(0.5);
  wire.tell = at(0.4);
  wire.run(1);
  wire.robot.restart();
  wire.run(0.3);
  EXPECT_EQ(wire.driver.phase(), Phase::configured);
  EXPECT_EQ(wire.driver.trouble(),
            "it has lost its activation (activating it opens and closes its fingers fully)");
  const double where = wire.where();
  wire.run(2);
  EXPECT_EQ(wire.where(), where) << "not by itself";
  wire.tell.reset();
  wire.driver.home();
  wire.run(8);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  wire.tell = at(0.4);
  wire.run(1.5);
  EXPECT_NEAR(wire.where(), 0.4, 0.008);
}

TEST(RobotiqDriver, OneThatAnswersForItIsNamed) {
  Wire wire;
  wire.run(0.5);
  wire.robot.answer_as(7);
  wire.run(0.5);
  EXPECT_EQ(wire.first_trouble, "id 9 does not answer, but id 7 does");
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.robot.answer_as(9);
  wire.run(1.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
}

TEST(RobotiqDriver, GarbageNowAndThenIsLeftOut) {
  Wire wire;
  wire.run(0.5);
  wire.spoil = garbage(3, 4);
  wire.tell = at(0.4);
  wire.run(8);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_EQ(wire.first_trouble, "");
  EXPECT_GT(wire.rejects, 10u);
  EXPECT_NEAR(wire.where(), 0.4, 0.008);
}

TEST(RobotiqDriver, NothingButGarbageIsALostWire) {
  Wire wire;
  wire.run(0.5);
  wire.spoil = noise(4);
  wire.run(1);
  EXPECT_EQ(wire.first_trouble, "the wire is lost");
}

// Answers that come after the next question was asked are not taken for its own.
TEST(RobotiqDriver, WhatComesLateLeadsItNowhere) {
  Wire wire;
  wire.run(0.5);
  std::vector<std::string> delayed;
  wire.spoil = [&delayed, random = Random(5)](std::string answer) mutable {
    if (answer.empty()) return answer;
    if (random.uniform() < 0.2) {
      delayed.push_back(std::move(answer));
      return std::string();
    }
    if (!delayed.empty()) {
      answer = delayed.front() + answer;
      delayed.erase(delayed.begin());
    }
    return answer;
  };
  for (const double goal : {0.5, 0.2, 0.6}) {
    wire.tell = at(goal);
    wire.run(3);
    EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
    EXPECT_NEAR(wire.where(), goal, 0.008);
  }
}

TEST(RobotiqDriver, AStuckFingerIsNamed) {
  Wire wire;
  wire.run(0.5);
  wire.robot.block(0, true);
  wire.tell = at(0.7);
  wire.run(3);
  EXPECT_EQ(wire.first_trouble, "grip is stuck");
}

TEST(RobotiqDriver, HeatEndsItUntilItIsCooler) {
  Wire wire;
  wire.run(0.5);
  wire.robot.heat(90);
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.driver.trouble(), "it is too hot");
  wire.robot.heat(40);
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
}

TEST(RobotiqDriver, ItRefusesWhatItCannotDrive) {
  EXPECT_TRUE(create_2f85(gripper(kind_2f85), {.baud = 115200}));
  EXPECT_FALSE(create_2f85(hand(), {.baud = 115200}));
  EXPECT_FALSE(create_2f85(gripper(kind_2f85), {.baud = 115200, .id = 254}));
}

}  // namespace
}  // namespace prehend::robot::robotiq
