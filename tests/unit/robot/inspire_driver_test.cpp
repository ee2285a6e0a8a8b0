// Frames of Inspire's hands, and their driver against an emulated one, in computed time.
#include "services/robot/core/inspire_driver.hpp"

#include <gtest/gtest.h>

#include "services/robot/core/inspire_emulator.hpp"
#include "tests/unit/robot/computed_wire.hpp"
#include "tests/unit/robot/hand_of_twelve.hpp"

namespace prehend::robot::inspire {
namespace {

const model::HandModel& rh56() {
  static const auto loaded = model::HandModel::load(model::hand_directory("inspire_rh56"));
  return *loaded;
}

// Inspire's SDK: all fingers open, its answer, and the question for the angles.
TEST(InspireProtocol, FramesAreThoseOfTheManufacturer) {
  Values open;
  open.fill(1000);
  EXPECT_EQ(encode(Side::asks, {1, Command::write, 1486, bytes_of(table::angle_set, open)}),
            bytes_of_hex("EB90010F12CE05E803E803E803E803E803E80377"));
  EXPECT_EQ(only_frame(Parser(Side::answers), bytes_of_hex("90EB010412CE0501EB")),
            (Frame{1, Command::write, 1486, "\1"}));
  EXPECT_EQ(encode(Side::asks, {1, Command::read, 1546, "\x0c"}),
            bytes_of_hex("EB900104110A060C32"));
}

TEST(InspireProtocol, ValuesAreReadAsTheyWereWritten) {
  const Values values{-1, 0, 1000, 513, -300, 7};
  EXPECT_EQ(values_of(table::angle_now, bytes_of(table::angle_now, values)), values);
  EXPECT_FALSE(values_of(table::angle_now, "12345"));
}

// Whatever stands before a frame, and in however many pieces it comes; a frame of which one bit is
// another is none.
TEST(InspireProtocol, FindsFramesAmongOtherBytes) {
  Random random(4);
  const std::string good = bytes_of_hex("90EB010412CE0501EB");
  for (int n = 0; n < 300; ++n) {
    std::string stream;
    for (std::size_t k = random.index(6); k > 0; --k)
      stream += static_cast<char>(random.uniform() < 0.5 ? 0x90 : 0x11);
    Parser parser(Side::answers);
    std::optional<Frame> found;
    for (const char c : stream + good) {
      parser.feed(std::string(1, c));
      if (auto frame = parser.next()) found = frame;
    }
    EXPECT_TRUE(found);
  }
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 4);
    Parser parser(Side::answers);
    parser.feed(bytes + std::string(100, '\x40'));
    EXPECT_FALSE(parser.next()) << i;
  }
}

Eigen::VectorXd share(double of_range) {
  Eigen::VectorXd dof(6);
  for (Eigen::Index d = 0; d < 6; ++d) {
    const model::HandDof& one = rh56().dofs()[static_cast<std::size_t>(d)];
    dof[d] = one.lower + of_range * (one.upper - one.lower);
  }
  return dof;
}

struct Wire : ComputedWire<Emulator, Driver> {
  Wire() : ComputedWire(Emulator(rh56(), {}), Driver(rh56(), {.baud = 115200})) {
    hear = [this](const std::string& said) {
      Parser parser(Side::asks);
      parser.feed(said);
      while (const auto frame = parser.next())
        if (frame->command == Command::write) written.push_back(*frame);
    };
  }
  double apart(const Eigen::VectorXd& dof) const {
    return (robot.measured() - dof).cwiseAbs().maxCoeff();
  }

  std::vector<Frame> written;
};

TEST(InspireDriver, IsReadyWithoutAMoveAndSaysNothingBefore) {
  Wire wire;
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_LT(wire.apart(where), 1e-9);
  EXPECT_TRUE(wire.written.empty());
  EXPECT_EQ(wire.driver.identity(), "Inspire RH56, id 1");
  EXPECT_EQ(*wire.driver.reading()->temperature, 32);
}

TEST(InspireDriver, FollowsWhatItIsTold) {
  Wire wire;
  wire.run(0.5);
  for (const double of_range : {0.6, 0.1, 0.95}) {
    wire.tell = share(of_range);
    wire.run(4);
    ASSERT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
    EXPECT_LT(wire.apart(*wire.tell), 0.01);
    EXPECT_LT((wire.driver.reading()->dof - *wire.tell).cwiseAbs().maxCoeff(), 0.01);
    EXPECT_LT(wire.driver.reading()->velocity.cwiseAbs().maxCoeff(), 0.01);
  }
  EXPECT_EQ(wire.rejects, 0u);
}

TEST(InspireDriver, TheEffortIsALimitOfForce) {
  Wire wire;
  wire.run(0.5);
  Eigen::VectorXd effort(6);
  effort << 0.3, 100, 0, 0.1, 0.2, 0.3;
  wire.driver.follow(share(0.3), effort, wire.now());
  wire.run(0.5);
  EXPECT_EQ(wire.robot.force_limit(0), std::lround(1000 * 0.3 / (0.35 * 1.9)));
  EXPECT_EQ(wire.robot.force_limit(1), 1000);
  EXPECT_EQ(wire.robot.force_limit(2), 0);
}

// Fast while it is far, slowly when it is near: so that its force limit is not passed.
TEST(InspireDriver, SlowsDownBeforeItsGoal) {
  Wire wire;
  wire.run(0.5);
  wire.tell = share(0.9);
  wire.run(0.2);
  EXPECT_GT(wire.robot.speed(0), 500);
  wire.run(3);
  EXPECT_EQ(wire.robot.speed(0), 25);
}

TEST(InspireDriver, WhatItHoldsItTellsAndKeepsHolding) {
  Wire wire;
  wire.run(0.5);
  wire.robot.measure(share(0.3));
  wire.run(0.5);
  Eigen::VectorXd effort = Eigen::VectorXd::Constant(6, 0.4);
  wire.driver.follow(share(0.6), effort, wire.now());
  wire.run(1);
  EXPECT_NEAR(wire.driver.reading()->effort[0], 0.4, 0.03);
  const Eigen::VectorXd pressed = wire.robot.driven();
  EXPECT_GT(pressed[0], share(0.3)[0] + 0.03);
  // Neither a hold nor a lost wire lets it go; and that is no finger that is stuck.
  wire.driver.hold();
  wire.run(3);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  wire.cut = true;
  wire.run(1);
  wire.cut = false;
  wire.run(1.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_LT((wire.robot.driven() - pressed).cwiseAbs().maxCoeff(), 0.02);
}

TEST(InspireDriver, HoldsStillWhereItIs) {
  Wire wire;
  wire.run(0.5);
  wire.tell = share(0.9);
  wire.run(0.3);
  wire.tell.reset();
  wire.driver.hold();
  const Eigen::VectorXd where = wire.robot.measured();
  EXPECT_LT(where[0], 1.2);
  wire.run(1);
  EXPECT_LT(wire.apart(where), 0.1);
}

TEST(InspireDriver, AFarewellStopsIt) {
  Wire wire;
  wire.run(0.5);
  wire.tell = share(0.9);
  wire.run(0.3);
  wire.robot.receive(wire.driver.farewell(), wire.passed());
  const Eigen::VectorXd where = wire.robot.measured();
  wire.robot.pass(wire.passed() + std::chrono::seconds(2));
  EXPECT_LT(wire.apart(where), 0.1);
}

TEST(InspireDriver, AfterALostWireItStaysUntilItIsTold) {
  Wire wire;
  wire.run(0.5);
  wire.tell = share(0.9);
  wire.run(0.1);
  wire.cut = true;
  wire.tell.reset();
  wire.run(0.5);
  EXPECT_EQ(wire.first_trouble, "the wire is lost");
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.cut = false;
  wire.run(1.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(1);
  EXPECT_LT(wire.apart(where), 1e-3);
  wire.tell = share(0.2);
  wire.run(4);
  EXPECT_LT(wire.apart(*wire.tell), 0.01);
}

// It forgets its goals, its force and its speed, and is told them again.
TEST(InspireDriver, ARestartIsMadeGood) {
  Wire wire;
  wire.run(0.5);
  wire.driver.follow(share(0.5), Eigen::VectorXd::Constant(6, 0.2), wire.now());
  wire.run(2);
  const int force = wire.robot.force_limit(0);
  wire.robot.restart();
  EXPECT_NE(wire.robot.force_limit(0), force);
  wire.run(2);
  EXPECT_EQ(wire.robot.force_limit(0), force);
  EXPECT_LT(wire.apart(share(0.5)), 0.01);
}

TEST(InspireDriver, OneThatAnswersForItIsNamed) {
  Wire wire;
  wire.run(0.5);
  wire.robot.answer_as(2);
  wire.run(0.5);
  EXPECT_EQ(wire.first_trouble, "id 1 does not answer, but id 2 does");
  wire.robot.answer_as(1);
  wire.run(1.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
}

TEST(InspireDriver, GarbageNowAndThenIsLeftOut) {
  Wire wire;
  wire.run(0.5);
  wire.spoil = garbage(3, 4);
  wire.tell = share(0.4);
  wire.run(8);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_EQ(wire.first_trouble, "");
  EXPECT_GT(wire.rejects, 10u);
  EXPECT_LT(wire.apart(*wire.tell), 0.01);
}

TEST(InspireDriver, NothingButGarbageIsALostWire) {
  Wire wire;
  wire.run(0.5);
  wire.spoil = noise(4);
  wire.run(1);
  EXPECT_EQ(wire.first_trouble, "the wire is lost");
}

TEST(InspireDriver, AStuckFingerIsNamedAndRecovers) {
  Wire wire;
  wire.run(0.5);
  wire.robot.block(2, true);
  wire.tell = share(0.8);
  wire.run(3);
  EXPECT_EQ(wire.first_trouble, "middle has stalled");
  const Eigen::VectorXd where = wire.robot.measured();
  wire.tell.reset();
  wire.robot.block(2, false);
  wire.run(2);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_LT(wire.apart(where), 0.1) << "until it is told again";
}

TEST(InspireDriver, HeatEndsItAndKeepsItUntilItIsCooler) {
  Wire wire;
  wire.run(0.5);
  wire.robot.heat(62);
  wire.run(1);
  EXPECT_EQ(wire.driver.trouble(), "too hot: 62 °C, of at most 60 °C");
  wire.robot.heat(59);
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  wire.robot.heat(50);
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
}

TEST(InspireDriver, ItRefusesWhatItCannotDrive) {
  EXPECT_TRUE(create(rh56(), {.baud = 115200}));
  EXPECT_FALSE(create(hand(), {.baud = 115200}));
}

}  // namespace
}  // namespace prehend::robot::inspire
