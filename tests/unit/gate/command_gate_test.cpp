// What the gate refuses, each reason by itself; who leads; and that what is within the limits
// leaves as it came.
#include "common/gate/command_gate.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/model/hand_effort.hpp"
#include "tests/unit/gate/fixtures.hpp"

namespace prehend::gate {
namespace {

using std::chrono::milliseconds;

std::optional<Refusal> refusal(CommandGate& gate, const Command& command, Time now) {
  const auto passed = gate.admit(command, now);
  return passed ? std::nullopt : std::optional(passed.error());
}

TEST(Gate, PassesWhatIsWithinTheLimitsToTheLastBit) {
  auto gate = made(test::hand("barrett"));
  for (int ms = 0; ms < 1000; ms += 33) {
    Command sent = command(test::hand("barrett"), 1, ms, {0.3, 0, 0.5 + 0.0009 * ms});
    sent.place.dof = test::hand("barrett").clamp(Eigen::VectorXd::Constant(4, 0.0024 * ms));
    const auto passed = gate.admit(sent, at(ms + 5));
    ASSERT_TRUE(passed) << to_string(passed.error());
    EXPECT_EQ(passed->place.dof, sent.place.dof);
    EXPECT_EQ(passed->place.X_WB.matrix(), sent.place.X_WB.matrix());
    for (const bool cut : passed->cut) EXPECT_FALSE(cut);
  }
}

TEST(Gate, RefusesWhatCannotBeMeant) {
  auto gate = made(test::hand("barrett"));
  Command broken = command(test::hand("barrett"), 1, 0);
  broken.place.dof[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::not_finite);
  broken = command(test::hand("barrett"), 1, 0);
  broken.place.X_WB.linear()(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::not_finite);
  broken = command(test::hand("barrett"), 1, 0);
  broken.hand = "other";
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::another_hand);
  broken = command(test::hand("barrett"), 1, 0);
  broken.model = "robonaut";
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::another_model);
  broken = command(test::hand("barrett"), 1, 0);
  broken.place.dof.resize(3);
  broken.place.dof.setZero();
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::wrong_length);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0, {0, 0, 300}), at(0)),
            Refusal::far_away);
  broken = command(test::hand("barrett"), 1, 0);
  broken.place.dof[1] = test::hand("barrett").dofs()[1].upper + 0.1;
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::outside_limits);
  broken = command(test::hand("barrett"), 1, 0);
  broken.place.effort = Eigen::VectorXd::Ones(3);
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::wrong_length);
  broken.place.effort = Eigen::Vector4d(0, 0, std::numeric_limits<double>::infinity(), 0);
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::not_finite);
  broken.place.effort = Eigen::Vector4d(0, 0, -0.1, 0);
  EXPECT_EQ(refusal(gate, broken, at(0)), Refusal::outside_limits);
  EXPECT_FALSE(gate.leader(at(0))) << "nonsense leads nothing";
}

TEST(Gate, CutsEffortsToThoseOfTheDrives) {
  auto gate = made(test::hand("barrett"));
  const Eigen::VectorXd most = model::max_effort(test::hand("barrett"));
  Command sent = command(test::hand("barrett"), 1, 0);
  auto passed = gate.admit(sent, at(0));
  ASSERT_TRUE(passed);
  EXPECT_EQ(passed->place.effort, most) << "all that it may";
  sent = command(test::hand("barrett"), 1, 10);
  sent.place.effort = 0.5 * most;
  passed = gate.admit(sent, at(10));
  ASSERT_TRUE(passed);
  EXPECT_EQ(passed->place.effort, sent.place.effort);
  EXPECT_FALSE(passed->has(Cut::effort));
  sent = command(test::hand("barrett"), 1, 20);
  sent.place.effort = 0.5 * most;
  sent.place.effort[2] = 3 * most[2];
  passed = gate.admit(sent, at(20));
  ASSERT_TRUE(passed);
  EXPECT_TRUE(passed->has(Cut::effort));
  EXPECT_EQ(passed->place.effort[2], most[2]);
  EXPECT_EQ(passed->place.effort[1], sent.place.effort[1]);
}

// A command that says nothing of efforts must not have those that the drives have.
TEST(Gate, GivesWhoAsksForNoEffortWhatIsAllowed) {
  Limits limits = limits_of(test::hand("barrett"));
  limits.effort *= 0.5;
  auto gate = CommandGate::create(test::hand("barrett"), {.hand = "hand"}, limits).value();
  const auto passed = gate.admit(command(test::hand("barrett"), 1, 0), at(0));
  ASSERT_TRUE(passed);
  EXPECT_EQ(passed->place.effort, limits.effort);
  EXPECT_FALSE(passed->has(Cut::effort));
  gate.stop("anna", "", at(10));
  EXPECT_EQ(gate.go(open_at(test::hand("barrett"), {0, 0, 0.5}), at(20)).place.effort,
            limits.effort);
}

TEST(Gate, RefusesWhatIsOldAndWhatIsFromTheFuture) {
  auto gate = made(test::hand("barrett"));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(201)), Refusal::too_old);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(3'600'000)), Refusal::too_old);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 201), at(0)), Refusal::from_future);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(200)), std::nullopt);
}

TEST(Gate, ObeysEachCommandOnceAndInOrder) {
  auto gate = made(test::hand("barrett"));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 20), at(20)), std::nullopt);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 20), at(21)),
            Refusal::not_newer);  // doubled
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 10), at(22)),
            Refusal::not_newer);  // swapped
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 30), at(30)), std::nullopt);
}

// Mapping tells the hand to stay 60 ms after the last posture, stamped then; the answer to a
// posture that was only late comes behind it with an older stamp. That is no swap: its number is
// the next.
TEST(Gate, ObeysTheLateAnswerBehindACommandToStay) {
  auto gate = made(test::hand("barrett"));
  Command stay = command(test::hand("barrett"), 1, 100);
  stay.sequence = 7;
  Command answer = command(test::hand("barrett"), 1, 60);
  answer.sequence = 8;
  EXPECT_EQ(refusal(gate, stay, at(100)), std::nullopt);
  EXPECT_EQ(refusal(gate, answer, at(130)), std::nullopt);
}

TEST(Gate, JudgesByStampsWhoDoesNotCount) {
  auto gate = made(test::hand("barrett"));
  for (int ms = 0; ms < 100; ms += 10) {
    Command sent = command(test::hand("barrett"), 1, ms);
    sent.sequence = 0;
    EXPECT_EQ(refusal(gate, sent, at(ms)), std::nullopt);
    EXPECT_EQ(refusal(gate, sent, at(ms + 1)), Refusal::not_newer);
  }
}

// A recording that is played again begins with its first number.
TEST(Gate, HearsWhoCountsAnewAfterASilence) {
  auto gate = made(test::hand("barrett"));
  Command sent = command(test::hand("barrett"), 1, 0);
  sent.sequence = 100;
  EXPECT_EQ(refusal(gate, sent, at(0)), std::nullopt);
  for (int ms = 10; ms <= 600; ms += 10) {
    Command again = command(test::hand("barrett"), 1, ms);
    again.sequence = static_cast<std::uint64_t>(ms / 10);
    EXPECT_EQ(refusal(gate, again, at(ms)),
              ms <= 300 ? std::optional(Refusal::not_newer) : std::nullopt)
        << ms;
  }
}

TEST(Gate, OneLeadsUntilItHasBeenSilent) {
  auto gate = made(test::hand("barrett"));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(0)), std::nullopt);
  EXPECT_EQ(gate.leader(at(0)), writer(1));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 2, 299), at(299)), Refusal::second_writer);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 300), at(300)), std::nullopt);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 2, 600), at(600)), Refusal::second_writer);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 2, 601), at(601)), std::nullopt);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 602), at(602)), Refusal::second_writer);
  EXPECT_EQ(gate.leader(at(602)), writer(2));
  EXPECT_EQ(gate.leads(), 2u);
  EXPECT_FALSE(gate.leader(at(1000)));
}

// Who sends only what is refused keeps nobody else from leading.
TEST(Gate, StaleCommandsDoNotKeepTheLead) {
  auto gate = made(test::hand("barrett"));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(0)), std::nullopt);
  for (int ms = 10; ms < 400; ms += 10) {
    Command old = command(test::hand("barrett"), 1, ms);
    old.stamp -= std::chrono::hours(1);
    EXPECT_EQ(refusal(gate, old, at(ms)), Refusal::too_old);
  }
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 2, 400), at(400)), std::nullopt);
}

TEST(Gate, IsTakenOverByWhoIsNamed) {
  auto gate = made(test::hand("barrett"));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(0)), std::nullopt);
  gate.take_over(writer(2), at(10));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 20), at(20)), Refusal::second_writer);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 2, 20), at(20)), std::nullopt);
}

// Between two leads the hand may have gone somewhere else than the last command: what counts is
// where it is, and 20 ms of the way from there.
TEST(Gate, ANewLeaderStartsFromWhereTheHandIs) {
  const Place here = open_at(test::hand("barrett"), {0.2, 0, 0.5});
  std::optional<Place> where;
  auto gate = made(test::hand("barrett"), [&] { return where; });
  const auto first = gate.admit(command(test::hand("barrett"), 1, 0, {1, 0, 0.5}), at(0));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->place.X_WB.translation().x(), 1) << "nobody knows where the hand is";
  where = here;
  const auto second = gate.admit(command(test::hand("barrett"), 2, 1000, {1, 0, 0.5}), at(1000));
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->has(Cut::base_speed));
  EXPECT_NEAR(second->place.X_WB.translation().x(), 0.2 + 1.2 * 0.02, 1e-9);
}

// After a silence the same writer goes on from its last command: what it holds, it holds with a
// squeeze that the measured joints do not show.
TEST(Gate, TheSameLeaderGoesOnAfterASilence) {
  auto gate = made(test::hand("barrett"), [] { return open_at(test::hand("barrett"), {5, 5, 5}); });
  ASSERT_TRUE(gate.admit(command(test::hand("barrett"), 1, 0, {5, 5, 5}), at(0)));
  const auto passed = gate.admit(command(test::hand("barrett"), 1, 2000, {5, 5, 5}), at(2000));
  ASSERT_TRUE(passed);
  EXPECT_EQ(passed->place.X_WB.translation(), Eigen::Vector3d(5, 5, 5));
}

TEST(Gate, AStopLatchesUntilTheReleaseAndTheFirstOneCounts) {
  Place here = open_at(test::hand("barrett"), {0, 0, 0.5});
  auto gate = made(test::hand("barrett"), [&] { return here; });
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(0)), std::nullopt);
  gate.stop("anna", "a noise", at(5));
  gate.stop("ben", "", at(6));
  ASSERT_TRUE(gate.stopped());
  EXPECT_EQ(gate.stopped()->by, "anna");
  EXPECT_EQ(gate.stopped()->reason, "a noise");
  for (int ms = 10; ms < 2000; ms += 10)
    EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, ms, {1, 0, 0.5}), at(ms)),
              Refusal::stopped);
  EXPECT_EQ(gate.leader(at(1990)), writer(1)) << "who leads goes on leading";
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 2, 1991), at(1991)),
            Refusal::second_writer);
  here = open_at(test::hand("barrett"), {0.1, 0, 0.5});
  gate.release();
  const auto passed = gate.admit(command(test::hand("barrett"), 1, 2000, {1, 0, 0.5}), at(2000));
  ASSERT_TRUE(passed);
  EXPECT_NEAR(passed->place.X_WB.translation().x(), 0.1 + 1.2 * 0.02, 1e-9);
}

TEST(Gate, AStoppedHandOpensWithinItsLimits) {
  Place here = open_at(test::hand("barrett"), {0, 0, 0.5});
  here.dof.setConstant(1);
  here.dof = test::hand("barrett").clamp(here.dof);
  const Place open = open_at(test::hand("barrett"), {0, 0, 0.5});
  auto gate = made(test::hand("barrett"), [&] { return here; });
  gate.stop("anna", "", at(0));
  Eigen::VectorXd before = here.dof;
  int ms = 0;
  for (; ms < 5000 && (before - open.dof).norm() > 1e-9; ms += 2) {
    const Passed passed = gate.go(open, at(ms));
    for (Eigen::Index i = 0; ms > 0 && i < before.size(); ++i)
      EXPECT_LE(
          std::abs(passed.place.dof[i] - before[i]),
          1.2 * test::hand("barrett").dofs()[static_cast<std::size_t>(i)].max_velocity * 0.002 +
              1e-9);
    before = passed.place.dof;
  }
  EXPECT_LT(ms, 1000);
}

// The deadman: 100 ms after it was held last, or as soon as it is let go, nothing is obeyed.
TEST(Gate, ObeysOnlyWithConsentWhereThatIsAsked) {
  auto gate = CommandGate::create(test::hand("barrett"), {.hand = "hand", .deadman = true},
                                  limits_of(test::hand("barrett")))
                  .value();
  const WriterId anna = writer(8), ben = writer(9);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 0), at(0)), Refusal::no_consent);
  gate.consent(anna, true, at(10), at(10));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 110), at(110)), std::nullopt);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 111), at(111)), Refusal::no_consent);
  gate.consent(anna, true, at(120), at(120));
  gate.consent(ben, false, at(121), at(121));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 130), at(130)), std::nullopt);
  gate.consent(anna, false, at(131), at(131));
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 140), at(140)), Refusal::no_consent);
  gate.consent(anna, true, at(0), at(300));  // consent of then
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 300), at(300)), Refusal::no_consent);
  gate.consent(anna, true, at(125), at(310));  // late
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 310), at(310)), Refusal::no_consent)
      << "what comes late must not undo that it was let go";
  gate.consent(anna, true, at(320), at(320));
  gate.consent(anna, true, at(320), at(400));  // doubled
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 420), at(420)), std::nullopt);
  EXPECT_EQ(refusal(gate, command(test::hand("barrett"), 1, 421), at(421)), Refusal::no_consent);
}

TEST(Gate, IsNotMadeWithLimitsThatAllowNothing) {
  Limits limits = limits_of(test::hand("barrett"));
  limits.joint[2].speed = 0;
  EXPECT_EQ(CommandGate::create(test::hand("barrett"), {}, limits).error().message(),
            "gate: speed and acceleration must be positive");
  limits = limits_of(test::hand("barrett"));
  limits.base.speed = 0;
  EXPECT_FALSE(CommandGate::create(test::hand("barrett"), {}, limits));
  limits = limits_of(test::hand("barrett"));
  limits.effort[1] = 0;
  EXPECT_FALSE(CommandGate::create(test::hand("barrett"), {}, limits));
  limits = limits_of(test::hand("barrett"));
  limits.box_upper = limits.box_lower;
  EXPECT_FALSE(CommandGate::create(test::hand("barrett"), {}, limits));
  EXPECT_FALSE(CommandGate::create(test::hand("barrett"), {}, limits_of(test::hand("robonaut"))));
}

}  // namespace
}  // namespace prehend::gate
