// A hand that an arm carries, behind operators of all kinds: what must hold in every step of the
// world for every arm and hand; stops; starts far away; and loads.
#include "common/carrying/carrying_arm.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "common/arm/mounting.hpp"
#include "services/simulation/core/simulation.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/arms/operators.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::simulation;
using arm::Hindrance;
using arm::Joints;
using carrying::ArmMotion;
using carrying::CarryingArm;
using Eigen::Vector3d;
using Eigen::VectorXd;
using std::chrono::milliseconds;

const Time start = from_ns(1'700'000'000'000'000'000);
constexpr double bracket = 0.7;

/// Stands at the table as in the configuration's defaults.
Pose at_the_table() {
  return make_pose(Vector3d(0, -0.7, 0),
                   Eigen::Quaterniond(Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitZ())));
}

Pose grip(const model::ArmModel& arm, const model::HandModel& hand) {
  return arm.X_EF * arm::mounted(hand, bracket);
}

std::unique_ptr<CarryingArm> carrying(const model::ArmModel& arm, const model::HandModel& hand) {
  auto made = CarryingArm::create(arm, hand, at_the_table(), grip(arm, hand));
  if (!made) throw std::runtime_error(made.error().message());
  return std::move(*made);
}

std::unique_ptr<Simulation> made(const model::ArmModel& arm, const model::HandModel& hand) {
  auto simulation = Simulation::create(hand, {}, carrying(arm, hand));
  if (!simulation) throw std::runtime_error(simulation.error().message());
  (*simulation)->follow(start, false);
  return std::move(*simulation);
}

Command command(const model::HandModel& hand, const Pose& X_WB) {
  Command told;
  told.model = hand.name();
  told.X_WB = X_WB;
  told.dof = hand.postures().at("open");
  return told;
}

/// What is wrong after a step of dt s.
std::string broken(const model::ArmModel& arm, const ArmMotion& before, const ArmMotion& now,
                   double dt) {
  for (Eigen::Index i = 0; i < now.told.size(); ++i) {
    const model::ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
    for (const double q : {now.told[i], now.joint[i]})
      if (!(q >= joint.lower - 1e-9 && q <= joint.upper + 1e-9)) return "range";
    if (!(std::abs(now.told_velocity[i]) <= joint.velocity + 1e-9)) return "velocity";
    if (std::abs(now.told_velocity[i] - before.told_velocity[i]) > joint.acceleration * dt + 1e-9)
      return "acceleration";
    if (std::abs(now.told[i] - before.told[i] - now.told_velocity[i] * dt) > 1e-9) return "jump";
    if (joint.max_torque > 0 && !(std::abs(now.torque[i]) <= joint.max_torque + 1e-9))
      return "torque";
  }
  return {};
}

class CarryingArmOf : public testing::TestWithParam<std::string> {};

TEST_P(CarryingArmOf, KeepsItsLimitsWithEveryHandWhateverIsWished) {
  const model::ArmModel& arm = test::arm(GetParam());
  const int frames = std::getenv("PREHEND_LONG") ? 5000 : 120;
  int hands = 0;
  for (const std::string& name : test::hand_names()) {
    const model::HandModel& hand = test::hand(name);
    if (!arm::check_fit(arm, hand)) continue;
    ++hands;
    const auto simulation = made(arm, hand);
    const Pose X_EB = grip(arm, hand);
    test::Operator operating(arm, static_cast<std::uint64_t>(hands));
    ArmMotion before = *simulation->arm_motion();
    Time now = start;
    for (int frame = 0; frame < frames; ++frame) {
      const Pose X_WB = at_the_table() * operating.next().first.X_WB * X_EB;
      if (is_finite(X_WB)) {
        ASSERT_TRUE(simulation->accept(command(hand, X_WB), now));
      }
      now += milliseconds(10);
      simulation->follow(now, true);
      while (simulation->step()) {
        const ArmMotion next = *simulation->arm_motion();
        ASSERT_EQ(broken(arm, before, next, 0.002), "") << name << ", frame " << frame;
        const Pose X_WB_told = at_the_table() * arm::end_pose(arm, next.joint) * X_EB;
        ASSERT_LT((X_WB_told.matrix() - next.X_WB.matrix()).norm(), 1e-9);
        before = next;
      }
    }
  }
  EXPECT_GE(hands, 4);
}

TEST_P(CarryingArmOf, StopsAsFastAsItsJointsCanAndStays) {
  const model::ArmModel& arm = test::arm(GetParam());
  const model::HandModel& hand = test::hand("rutgers");
  const auto simulation = made(arm, hand);
  Pose goal = simulation->world().base();
  goal.pretranslate(Vector3d(0.3, 0.1, 0.1));
  ASSERT_TRUE(simulation->accept(command(hand, goal), start));
  const auto run = [&](int ms) {
    simulation->follow(start + milliseconds(ms), true);
    while (simulation->step()) {
    }
    return *simulation->arm_motion();
  };
  const ArmMotion moving = run(150);
  EXPECT_GT(moving.told_velocity.norm(), 0.1);
  simulation->hold();
  EXPECT_TRUE(simulation->is_braking());
  double needs = 0;  // s
  for (Eigen::Index i = 0; i < moving.told_velocity.size(); ++i)
    needs = std::max(needs, std::abs(moving.told_velocity[i]) /
                                arm.joints[static_cast<std::size_t>(i)].acceleration);
  const ArmMotion stopped = run(150 + static_cast<int>(1000 * needs) + 10);
  EXPECT_LT(stopped.told_velocity.norm(), 1e-9);
  EXPECT_EQ(stopped.hindrance, Hindrance::no_wish);
  EXPECT_FALSE(simulation->is_braking());
  const Vector3d there = simulation->world().base().translation();
  const ArmMotion later = run(3000);
  EXPECT_LT((later.told - stopped.told).norm(), 1e-12);
  EXPECT_LT((simulation->world().base().translation() - there).norm(), 1e-5);
  // The next command leads it on.
  ASSERT_TRUE(simulation->accept(command(hand, goal), start + milliseconds(3000)));
  EXPECT_GT(run(3100).told_velocity.norm(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(All, CarryingArmOf, testing::ValuesIn(test::arm_names()));

/// The Puma with the Barrett hand follows this for so long, s; 50 Hz.
ArmMotion follow(Simulation& simulation, Time& now, double duration,
                 const std::function<Command(double)>& told) {
  const Time begun = now;
  while (to_seconds(now - begun) < duration) {
    if (!simulation.accept(told(to_seconds(now - begun)), now)) throw std::runtime_error("refused");
    now += milliseconds(20);
    simulation.follow(now, true);
    while (simulation.step()) {
    }
  }
  return *simulation.arm_motion();
}

/// G at p, the palm along y and its x axis up: as a person before the table reaches.
Command reach(const Vector3d& p, double closure) {
  const model::HandModel& hand = test::hand("barrett");
  const Eigen::Matrix3d R = model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  Command told = command(hand, make_pose(p, R) * hand.X_BG().inverse());
  told.dof = VectorXd::Constant(4, closure);
  told.dof[0] = 0;
  return told;
}

TEST(CarryingArm, BeginsAtHomeAndComesFromFarAway) {
  const auto simulation = made(test::arm("puma560"), test::hand("barrett"));
  EXPECT_LT((simulation->world().base().matrix() - simulation->arm()->home().matrix()).norm(),
            1e-9);
  Time now = start;
  const Command far = reach({-0.1, -0.2, 0.25}, 0);
  EXPECT_GT((far.X_WB.translation() - simulation->world().base().translation()).norm(), 0.2);
  ASSERT_TRUE(simulation->accept(far, now));
  EXPECT_GT((far.X_WB.translation() - simulation->world().base().translation()).norm(), 0.2)
      << "it was put there";
  const ArmMotion there = follow(*simulation, now, 4, [&](double) { return far; });
  EXPECT_EQ(there.hindrance, Hindrance::none) << to_string(there.hindrance) << " " << there.off_m;
  EXPECT_LT((far.X_WB.translation() - simulation->world().base().translation()).norm(), 2e-3);
}

TEST(CarryingArm, BrakesWhenCommandsStop) {
  const auto simulation = made(test::arm("puma560"), test::hand("barrett"));
  ASSERT_TRUE(simulation->accept(reach({-0.1, -0.2, 0.25}, 0), start));
  simulation->follow(start + milliseconds(1000), true);
  while (simulation->step()) {
  }
  EXPECT_TRUE(simulation->is_holding_still());
  EXPECT_LT(simulation->arm_motion()->told_velocity.norm(), 1e-9);
  EXPECT_EQ(simulation->arm_motion()->hindrance, Hindrance::no_wish);
}

TEST(CarryingArm, OutOfReachItSaysSo) {
  const auto simulation = made(test::arm("puma560"), test::hand("barrett"));
  Time now = start;
  const Command far = reach({0, 0.6, 0.3}, 0);
  const ArmMotion there = follow(*simulation, now, 7, [&](double) { return far; });
  EXPECT_EQ(there.hindrance, Hindrance::reach) << to_string(there.hindrance);
  EXPECT_GT(there.off_m, 0.1);
  EXPECT_LT(there.told_velocity.norm(), 0.01);
}

// A hand that flies went through the table.
TEST(CarryingArm, DoesNotPushTheHandThroughTheTable) {
  const auto simulation = made(test::arm("puma560"), test::hand("barrett"));
  Time now = start;
  follow(*simulation, now, 3, [](double) { return reach({0, -0.1, 0.2}, 0); });
  const ArmMotion down = follow(*simulation, now, 3, [](double t) {
    return reach({0, -0.1, std::max(-0.15, 0.2 - 0.2 * t)}, 0);
  });
  // The palm is 10 cm wide, so its middle stays above the table.
  EXPECT_GT((simulation->world().base() * test::hand("barrett").X_BG()).translation().z(), 0.02);
  EXPECT_EQ(down.hindrance, Hindrance::collision) << to_string(down.hindrance);
  const ArmMotion up = follow(*simulation, now, 4, [](double) { return reach({0, -0.1, 0.2}, 0); });
  EXPECT_EQ(up.hindrance, Hindrance::none) << to_string(up.hindrance) << " " << up.off_m;
}

/// Reaches, closes and lifts what stands at the origin; its height above the table at the end.
double lift(model::ArmModel puma, double mass, ArmMotion& end) {
  grasping::Body talc{
      "Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, mass, "plastic", {}};
  talc.friction = 2.0;  // heavy things are not to slip
  const auto simulation = made(puma, test::hand("barrett"));
  if (!simulation->see(talc, Pose::Identity())) throw std::runtime_error("not placed");
  Time now = start;
  follow(*simulation, now, 4, [](double t) {
    return reach({0, -0.25 * std::clamp(3.5 - t, 0.0, 1.0), 0.06}, 0);
  });
  follow(*simulation, now, 1.5, [](double t) {
    return reach({0, 0, 0.06}, std::min(1.4, 1.5 * t));
  });
  end = follow(*simulation, now, 2.5, [](double t) {
    return reach({0, 0, 0.06 + 0.1 * std::min(1.0, t)}, 1.4);
  });
  return simulation->world().body_motion(0).X_WO.translation().z() - 0.0525;
}

TEST(CarryingArm, LiftsWhatItsPayloadAllowsAndRefusesWhatIsMuchTooHeavy) {
  model::ArmModel puma = test::arm("puma560");
  ArmMotion end;
  EXPECT_NEAR(lift(puma, 0.3, end), 0.1, 0.02);
  EXPECT_FALSE(end.too_heavy);
  EXPECT_NEAR(end.carried, arm::weight_of(test::hand("barrett")) + 0.3, 0.05);
  EXPECT_LT(end.off_m, 2e-3);
  puma.payload = 2.05;  // of which the hand is 2 kg
  EXPECT_LT(lift(puma, 0.8, end), 0.05);
  EXPECT_TRUE(end.too_heavy);
}

TEST(CarryingArm, IsDeterministic) {
  const auto once = [] {
    const auto simulation = made(test::arm("puma560"), test::hand("barrett"));
    Time now = start;
    return follow(*simulation, now, 1, [](double t) { return reach({0, -0.2, 0.1}, t); });
  };
  const ArmMotion a = once(), b = once();
  EXPECT_EQ(a.joint, b.joint);
  EXPECT_EQ(a.torque, b.torque);
}

TEST(CarryingArm, CarriesOneHandAlone) {
  const auto& puma = test::arm("puma560");
  const auto& hand = test::hand("barrett");
  const auto several = Simulation::create(hand, {.push = push_of_several}, carrying(puma, hand));
  ASSERT_FALSE(several);
  EXPECT_EQ(several.error().what, "an arm carries one hand alone");
  EXPECT_EQ(made(puma, hand)->add_hand(hand).error().message(), several.error().message());
}

TEST(CarryingArm, RefusesAHandThatIsTooHeavy) {
  const auto refused = CarryingArm::create(test::arm("puma560"), test::hand("robonaut"),
                                           at_the_table(), Pose::Identity());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().exit, exit_wrong_use);
}

}  // namespace
