// The driver of DYNAMIXEL servos against emulated ones, in computed time: a hand of twelve.
#include "services/robot/core/dynamixel_driver.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/robot/core/dynamixel_emulator.hpp"
#include "tests/support/wires/wired_hands.hpp"
#include "tests/unit/robot/computed_wire.hpp"
#include "tests/unit/robot/hand_of_twelve.hpp"

namespace prehend::robot::dynamixel {
namespace {

std::vector<Servo> servos() {
  return *parse_wiring(test::servo_wiring(hand()), hand(), "w.toml");
}

struct Wire : ComputedWire<Emulator, Driver> {
  explicit Wire(const EmulatedOptions& options = {})
      : ComputedWire(Emulator(hand(), servos(), options),
                     Driver(hand(), {.baud = 1000000, .wiring_file = "w.toml"}, servos())) {}

  /// A question of somebody else on the line.
  std::string ask(std::uint8_t id, Instruction instruction, const std::string& parameters) {
    Parser parser;
    parser.feed(robot.receive(encode({id, instruction, parameters}), passed()));
    const auto answer = parser.next();
    return answer ? answer->parameters : "";
  }
  int read(std::uint8_t id, const Item& item) {
    const std::string answer = ask(id, Instruction::read, read_of(item));
    return number(std::string_view(answer).substr(1));
  }
};

TEST(DynamixelDriver, IsReadyWithoutAMove) {
  Wire wire;
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_NE(wire.driver.identity().find("12 DYNAMIXEL servos"), std::string::npos);
  EXPECT_EQ(wire.read(20, table::operating_mode), current_based_position);
  EXPECT_EQ(wire.read(20, table::torque_enable), 1);
  EXPECT_EQ(wire.read(20, table::watchdog), 17);  // 340 ms
  EXPECT_EQ(*wire.driver.reading()->temperature, 32);
}

TEST(DynamixelDriver, FollowsWhatItIsTold) {
  Wire wire;
  wire.run(2);
  wire.tell = posture(0.5);
  wire.run(4);
  ASSERT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
  EXPECT_LT((wire.driver.reading()->dof - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
  EXPECT_EQ(wire.rejects, 0u);
}

TEST(DynamixelDriver, AServoPressesWithTheEffortThatItIsAllowed) {
  Wire wire;
  wire.run(2);
  Eigen::VectorXd effort(12);
  effort.setConstant(0.2);
  wire.driver.follow(posture(0.3), effort, wire.now());
  wire.run(0.5);
  EXPECT_EQ(wire.read(20, table::goal_current), 400);  // 0.2 N m at 0.5 N m/A
  EXPECT_EQ(wire.read(19, table::goal_current), 200);  // the same with half the torque
  effort.setConstant(100);
  wire.driver.follow(posture(0.3), effort, wire.now());
  wire.run(0.5);
  EXPECT_EQ(wire.read(20, table::goal_current), 900);
  // What is in its way it presses against, and says so.
  wire.robot.block(0, true);
  effort.setConstant(0.2);
  wire.driver.follow(posture(0.4), effort, wire.now());
  wire.run(0.5);
  EXPECT_NEAR(wire.driver.reading()->effort[0], 0.2, 0.02);
}

TEST(DynamixelDriver, HoldsStillWhereItIs) {
  Wire wire;
  wire.run(2);
  wire.tell = posture(0.9);
  wire.run(0.2);
  wire.tell.reset();
  wire.driver.hold();
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(1);
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((wire.robot.measured() - posture(0.9)).cwiseAbs().minCoeff(), 10);
}

TEST(DynamixelDriver, ACutWireStopsTheServosThemselves) {
  Wire wire;
  wire.run(2);
  wire.tell = posture(0.9);
  wire.run(0.1);
  wire.cut = true;
  wire.run(0.4);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.driver.trouble(), "the wire is lost");
  // They went on until their watchdogs barked; then no more.
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(2);
  EXPECT_EQ(wire.robot.measured(), where);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.tell.reset();
  wire.cut = false;
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 1e-3);
  wire.tell = posture(0.2);
  wire.run(4);
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
}

TEST(DynamixelDriver, GarbageNowAndThenIsLeftOut) {
  Wire wire;
  wire.run(2);
  wire.spoil = garbage(3, 4);
  wire.tell = posture(0.4);
  wire.run(8);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_GT(wire.rejects, 10u);
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
}

TEST(DynamixelDriver, NothingButGarbageIsALostWire) {
  Wire wire;
  wire.run(2);
  wire.spoil = noise(4);
  wire.run(1);
  EXPECT_EQ(wire.first_trouble, "the wire is lost");
}

TEST(DynamixelDriver, AStuckJointIsNamed) {
  Wire wire;
  wire.run(2);
  wire.robot.block(1, true);
  wire.tell = posture(0.9);
  wire.run(3);
  EXPECT_EQ(wire.first_trouble, "servo 19 (" + hand().dofs()[1].name + ") is stuck");
}

TEST(DynamixelDriver, HeatEndsItAndKeepsItUntilItIsCooler) {
  Wire wire;
  wire.run(2);
  wire.robot.heat(62);
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.driver.trouble(), "too hot: 62 °C, of at most 60 °C");
  wire.robot.heat(59);
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.robot.heat(50);
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
}

TEST(DynamixelDriver, AServoThatShutItselfDownIsNamedUntilItIsSwitchedOffAndOn) {
  Wire wire;
  wire.run(2);
  wire.robot.heat(90);
  wire.run(0.3);
  wire.robot.heat(30);
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_NE(wire.driver.trouble().find("overheated; switch it off and on"), std::string::npos)
      << wire.driver.trouble();
  wire.ask(broadcast, Instruction::reboot, {});
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
}

TEST(DynamixelDriver, AJointOutsideItsRangeIsNotLed) {
  Wire wire;
  Eigen::VectorXd where = posture(0.2);
  where[3] = hand().dofs()[3].upper + 0.3;
  wire.robot.measure(where);
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_NE(wire.driver.trouble().find("outside its range"), std::string::npos);
  for (const Servo& servo : servos()) EXPECT_EQ(wire.read(servo.id, table::torque_enable), 0);
}

TEST(DynamixelDriver, AMissingServoIsNamed) {
  auto wired = servos();
  wired.pop_back();
  ComputedWire<Emulator, Driver> wire(Emulator(hand(), wired, {}),
                                      Driver(hand(), {.baud = 1000000}, servos()));
  wire.run(3);
  EXPECT_NE(wire.first_trouble.find("servo 9 ("), std::string::npos) << wire.first_trouble;
  EXPECT_NE(wire.first_trouble.find("does not answer"), std::string::npos);
}

TEST(DynamixelDriver, AFarewellStopsTheServos) {
  Wire wire;
  wire.run(2);
  wire.tell = posture(0.9);
  wire.run(0.2);
  wire.robot.receive(wire.driver.farewell(), wire.passed());
  const Eigen::VectorXd where = wire.robot.measured();
  wire.robot.pass(wire.passed() + std::chrono::seconds(4));
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 0.1);
}

TEST(DynamixelDriver, ItRefusesWhatItCannotDrive) {
  EXPECT_TRUE(create(hand(), {.baud = 57600, .wiring = test::servo_wiring(hand())}));
  EXPECT_FALSE(create(hand(), {.baud = 57600}));
  EXPECT_FALSE(create(hand(), {.baud = 1234, .wiring = test::servo_wiring(hand())}));
}

}  // namespace
}  // namespace prehend::robot::dynamixel
