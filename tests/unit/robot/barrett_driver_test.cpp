// The driver of a BarrettHand against the emulated one, in computed time.
#include "services/robot/core/barrett_driver.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "common/base/random.hpp"
#include "services/robot/core/barrett_emulator.hpp"
#include "tests/unit/robot/computed_wire.hpp"

namespace prehend::robot::barrett {
namespace {

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("barrett"));
  return *loaded;
}

struct Wire : ComputedWire<Emulator, Driver> {
  explicit Wire(const EmulatedOptions& options = {.initialized = true},
                const DriverOptions& told = {.baud = 38400})
      : ComputedWire(Emulator(hand(), options), Driver(hand(), told)) {}
};

Eigen::VectorXd dof(double spread, double f1, double f2, double f3) {
  Eigen::VectorXd q(4);
  q << spread, f1, f2, f3;
  return q;
}

TEST(BarrettDriver, HomesWhatDoesNotKnowItsJoints) {
  Wire wire{EmulatedOptions{}};
  EXPECT_EQ(wire.driver.phase(), Phase::offline);
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::configured);
  EXPECT_FALSE(wire.driver.reading());
  EXPECT_NE(wire.driver.identity().find("BH8-262"), std::string::npos);
  wire.driver.home();
  wire.run(0.01);
  EXPECT_EQ(wire.driver.phase(), Phase::homing);
  wire.run(4);
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
}

TEST(BarrettDriver, StoppedWhileItHomesItMovesNoMore) {
  Wire wire{EmulatedOptions{}};
  wire.run(1);
  wire.driver.home();
  wire.run(0.1);
  ASSERT_EQ(wire.driver.phase(), Phase::homing);
  wire.driver.hold();
  wire.run(0.05);
  const Eigen::VectorXd where = wire.robot.measured();
  EXPECT_GT(where[1], 0.2);
  wire.run(2);
  EXPECT_EQ(wire.robot.measured(), where);
  EXPECT_EQ(wire.driver.phase(), Phase::configured);
  wire.driver.home();
  wire.run(5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
}

TEST(BarrettDriver, AReadyHandHomesAgain) {
  Wire wire;
  wire.run(1);
  wire.tell = dof(0, 1, 1, 1);
  wire.run(2);
  wire.tell.reset();
  wire.driver.home();
  wire.run(5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
  EXPECT_LT(wire.robot.measured().maxCoeff(), 0.01);
}

TEST(BarrettDriver, AHotHandIsNotHomed) {
  Wire wire{EmulatedOptions{}};
  wire.robot.heat(70);
  wire.run(1);
  ASSERT_EQ(wire.driver.phase(), Phase::faulted);
  const Eigen::VectorXd where = wire.robot.measured();
  wire.driver.home();
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.robot.measured(), where);
}

/// As for people at terminals: each line comes back, and a line ends after LOOP's answer, too.
TEST(BarrettDriver, AHandThatEchoesIsUnderstood) {
  Wire wire;
  std::string asked;
  wire.hear = [&](const std::string& said) {
    const std::size_t end = said.find('\r');
    asked = end == std::string::npos ? "" : said.substr(0, end) + "\r\n";
  };
  wire.spoil = [&](std::string answer) {
    if (answer == "*" && asked.find("LOOP") != std::string::npos) answer += "\r\n";
    return std::exchange(asked, {}) + answer;
  };
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_NE(wire.driver.identity().find("BH8-262"), std::string::npos);
}

TEST(BarrettDriver, FollowsWhatItIsTold) {
  for (const int bytes : {0, 1, 2})
    for (const double scale : {0.6, 1.0, 1.7}) {
      Wire wire{{.initialized = true, .temperature_bytes = bytes, .velocity_scale = scale}};
      wire.run(1);
      ASSERT_EQ(wire.driver.phase(), Phase::ready) << bytes;
      wire.tell = dof(1, 0.5, 1.5, 2.4);
      wire.run(4);
      ASSERT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
      EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.01) << scale;
      EXPECT_LT((wire.driver.reading()->dof - *wire.tell).cwiseAbs().maxCoeff(), 0.01);
      EXPECT_EQ(wire.driver.reading()->temperature.has_value(), bytes > 0);
      EXPECT_EQ(wire.rejects, 0u);
    }
}

TEST(BarrettDriver, HoldsStillWhereItIs) {
  Wire wire;
  wire.run(1);
  wire.tell = dof(0, 2, 2, 2);
  wire.run(0.3);
  wire.tell.reset();
  wire.driver.hold();
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(1);
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_GT(where[1], 0.1);
}

TEST(BarrettDriver, ACutWireIsNoticedInTimeAndHealed) {
  Wire wire;
  wire.run(1);
  wire.tell = dof(0, 1, 1, 1);
  wire.run(1);
  wire.cut = true;
  wire.run(0.29);
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
  wire.run(0.1);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.driver.trouble(), "the wire is lost");
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.cut = false;
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
}

TEST(BarrettDriver, GarbageNowAndThenIsLeftOut) {
  Wire wire;
  wire.run(1);
  Random random(3);
  wire.spoil = [&random](std::string answer) {
    if (!answer.empty() && random.uniform() < 0.05) answer.insert(0, "\x17\x80*");
    if (!answer.empty() && random.uniform() < 0.05) answer.pop_back();
    return answer;
  };
  wire.tell = dof(0.5, 1, 1.2, 1.4);
  wire.run(6);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_GT(wire.rejects, 5u);
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.02);
}

TEST(BarrettDriver, NothingButGarbageIsALostWire) {
  Wire wire;
  wire.run(1);
  Random random(4);
  wire.spoil = [&random](std::string answer) {
    for (char& c : answer) c = static_cast<char>(random.bits() & 0xff);
    return answer;
  };
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
}

TEST(BarrettDriver, ALateAnswerIsNotTakenForTheNextOne) {
  Wire wire;
  wire.run(1);
  std::string held;
  int left = 0;
  wire.spoil = [&](std::string answer) {
    if (left == 0 && !answer.empty()) {
      left = 60;
      held = answer;
      return std::string();
    }
    if (left > 0 && --left == 20) return answer + std::exchange(held, {});
    return answer;
  };
  wire.tell = dof(0.2, 0.6, 0.7, 0.8);
  wire.run(8);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_GT(wire.rejects, 3u);
  EXPECT_LT((wire.driver.reading()->dof - wire.robot.measured()).cwiseAbs().maxCoeff(), 0.02);
}

// Guards a fault of busy machines: with 2 s allowed, two answers in a row that did not come within
// 40 ms were «the wire is lost».
TEST(BarrettDriver, TwoAnswersThatAreMissingAreNoLostWire) {
  Wire wire({.initialized = true}, {.baud = 38400, .lost_after = std::chrono::seconds(2)});
  wire.run(1);
  int left = 2;
  Duration until{};
  wire.hear = [&](const std::string&) {
    if (left == 0 || wire.passed() < until) return;
    --left;
    until = wire.passed() + std::chrono::milliseconds(80);
  };
  wire.spoil = [&](std::string answer) {
    return wire.passed() < until ? std::string() : std::move(answer);
  };
  wire.tell = dof(0.2, 0.6, 0.7, 0.8);
  wire.run(4);
  EXPECT_EQ(left, 0);
  EXPECT_GE(wire.rejects, 2u);
  EXPECT_EQ(wire.first_trouble, "");
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.02);
}

TEST(BarrettDriver, AStuckJointIsNamed) {
  Wire wire;
  wire.run(1);
  wire.robot.block(2, true);  // finger 2
  wire.tell = dof(0, 1, 1, 1);
  wire.run(3);
  EXPECT_EQ(wire.first_trouble, "finger 2 is stuck");
}

TEST(BarrettDriver, HeatEndsItAndKeepsItUntilItIsCooler) {
  Wire wire;
  wire.run(1);
  wire.robot.heat(61);
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.driver.trouble(), "too hot: 61.0 °C, of at most 60.0 °C");
  wire.robot.heat(59);
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.robot.heat(50);
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::ready);
  // Its own limit: it leaves RealTime mode and says why.
  wire.first_trouble.clear();
  wire.robot.heat(101);
  wire.run(0.3);
  EXPECT_NE(wire.first_trouble.find("too hot"), std::string::npos) << wire.first_trouble;
}

TEST(BarrettDriver, AFarewellStopsTheMotors) {
  Wire wire;
  wire.run(1);
  wire.tell = dof(0, 2, 2, 2);
  wire.run(0.3);
  wire.robot.receive(wire.driver.farewell(), std::chrono::seconds(2));
  const Eigen::VectorXd where = wire.robot.measured();
  wire.robot.pass(std::chrono::seconds(4));
  EXPECT_EQ(wire.robot.measured(), where);
}

/// A simulated hand that follows the motors does so a tenth of a second later, and what is in its
/// way is felt as late.
TEST(BarrettDriver, ATwinThatIsLateDoesNotMakeItSwing) {
  Wire wire;
  std::deque<Eigen::VectorXd> late(50, wire.robot.measured());  // 2 ms each
  double most = 0;
  const auto run = [&](double seconds_long, double wall) {
    for (double t = 0; t < seconds_long; t += 0.002) {
      late.push_back(wire.robot.driven().cwiseMin(wall));
      wire.robot.measure(late.front());
      most = std::max(most, late.front()[0]);
      late.pop_front();
      wire.run(0.002);
    }
  };
  run(1, 9);
  ASSERT_EQ(wire.driver.phase(), Phase::ready);
  wire.tell = dof(0.5, 0.8, 1, 1.05);
  run(1.5, 9);
  EXPECT_LT(most, 0.53);
  most = 0;
  run(1, 9);
  EXPECT_LT(most, 0.505);
  EXPECT_LT((late.front() - *wire.tell).cwiseAbs().maxCoeff(), 0.01);
  // A contact is where the fingers stay, and they press.
  wire.tell = dof(0.5, 1.15, 1.15, 1.35);
  run(1.5, 1.1);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_NEAR(wire.driver.reading()->dof[3], 1.25, 0.02);
  EXPECT_NEAR(wire.robot.driven()[3], 1.25, 0.02);
}

TEST(BarrettDriver, ItRefusesAnotherHand) {
  const auto other = model::HandModel::load(model::hand_directory("robonaut"));
  ASSERT_TRUE(other);
  EXPECT_FALSE(create(*other, {}));
  EXPECT_FALSE(create(hand(), {.baud = 1234}));
}

}  // namespace
}  // namespace prehend::robot::barrett
