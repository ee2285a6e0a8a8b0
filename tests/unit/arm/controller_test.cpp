// Follows operators of all kinds with every arm: what must hold in every frame whatever they do,
// and where the hand ends up when they are reasonable.
#include "common/arm/controller.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "common/arm/inverse.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/arms/operators.hpp"

using namespace prehend;
using arm::Controller;
using arm::Guidance;
using arm::Hindrance;
using arm::Joints;

namespace {

constexpr double dt = 0.01;

arm::ControllerOptions on_a_table(const model::ArmModel& model) {
  arm::ControllerOptions options;
  options.surroundings.table = 0.0;
  const Pose X_LF = model.X_LE * model.X_EF;  // a hand
  options.surroundings.carried = {
      {X_LF * Eigen::Vector3d(0, 0, 0.05), X_LF * Eigen::Vector3d(0, 0, 0.15), 0.04}};
  return options;
}

/// Not {X_WB, {}}: that leaves the numbers of the velocity unset.
arm::Wish resting(const Pose& X_WB) {
  return {.X_WB = X_WB, .velocity_W = arm::Vector6::Zero()};
}

/// What holds between two frames; the first that does not, or nothing.
std::string broken(const model::ArmModel& model, const Joints& q, const Joints& v,
                   const Guidance& next, double step) {
  if (!next.q.allFinite() || !next.velocity.allFinite()) return "not finite";
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const model::ArmJoint& joint = model.joints[static_cast<std::size_t>(i)];
    if (next.q[i] < joint.lower - 1e-9 || next.q[i] > joint.upper + 1e-9) return "range";
    if (std::abs(next.velocity[i]) > joint.velocity + 1e-9) return "velocity";
    if (std::abs(next.velocity[i] - v[i]) > joint.acceleration * step + 1e-9) return "acceleration";
    if (std::abs(next.q[i] - q[i] - next.velocity[i] * step) > 1e-12) return "jump";
  }
  return {};
}

class ControllerOf : public testing::TestWithParam<std::string> {
 protected:
  const model::ArmModel& model = test::arm(GetParam());

  /// Follows a fixed wish for `seconds`.
  Guidance settle(Controller& controller, const Pose& X_WB, double seconds = 6) const {
    Guidance guidance;
    for (int k = 0; k < seconds / dt; ++k) guidance = controller.step(resting(X_WB), dt);
    return guidance;
  }
};

TEST_P(ControllerOf, NeverJumpsBreaksALimitOrTouches) {
  const int motions = std::getenv("PREHEND_LONG") ? 10'000 : 40;
  const arm::ControllerOptions options = on_a_table(model);
  const arm::Collision collision(model, options.surroundings);
  double least = 1;
  for (int k = 0; k < motions; ++k) {
    Controller controller(model, options);
    test::Operator operating(model, static_cast<std::uint64_t>(k));
    Joints q = controller.posture(), v = controller.velocity();
    for (int frame = 0; frame < 250; ++frame) {
      const auto [wish, step] = operating.next();
      const Guidance next = controller.step(wish, step);
      ASSERT_EQ(broken(model, q, v, next, step), "") << "motion " << k << " frame " << frame;
      least = std::min(least, collision.clearance(arm::forward(model, next.q), 0.1));
      ASSERT_GT(least, 0.4 * options.clearance) << "motion " << k << " frame " << frame;
      q = next.q;
      v = next.velocity;
    }
  }
  std::cout << GetParam() << ": " << motions << " motions, least clearance " << 1e3 * least
            << " mm\n";
}

// Every wish near home is fulfilled, unless the arm would touch itself or the table there.
TEST_P(ControllerOf, ComesToAWishNearBy) {
  int reached = 0, free = 0;
  const int wishes = 40;
  Random random(7);
  const arm::ControllerOptions options = on_a_table(model);
  const arm::Collision collision(model, options.surroundings);
  for (int k = 0; k < wishes; ++k) {
    Controller controller(model, options);
    Pose X_WB = arm::end_pose(model, model.home);
    X_WB.translation() += random.normal3(0.04);
    X_WB.rotate(Eigen::AngleAxisd(random.normal(0.2), random.normal3(1).normalized()));
    const Guidance end = settle(controller, X_WB, 4);
    EXPECT_EQ(end.hindrance == Hindrance::none, end.off_m < 1e-3 && end.off_rad < 5e-3);
    const auto there = arm::refine(model, X_WB, model.home);
    if (!there || collision.clearance(arm::forward(model, *there), 0.1) < options.clearance) {
      EXPECT_EQ(end.hindrance, Hindrance::collision) << "wish " << k;
      continue;
    }
    ++free;
    reached += end.hindrance == Hindrance::none ? 1 : 0;
  }
  EXPECT_GE(free, wishes / 2);
  EXPECT_GE(reached, free * 9 / 10);
}

TEST_P(ControllerOf, OutOfReachItStretchesAndComesBack) {
  Controller controller(model, on_a_table(model));
  const Pose home = arm::end_pose(model, model.home);
  Pose far = home;
  const Eigen::Vector3d out =
      (home.translation() - model.X_AS.translation()).cwiseProduct(Eigen::Vector3d(1, 1, 0.2));
  far.translation() += 3 * out.normalized();
  const double wished = (far.translation() - home.translation()).norm();
  const Guidance stretched = settle(controller, far);
  EXPECT_NE(stretched.hindrance, Hindrance::none);
  EXPECT_NE(stretched.hindrance, Hindrance::on_the_way) << "it must come to rest";
  EXPECT_LT(stretched.velocity.norm(), 5e-3) << "and not swing about the nearest posture";
  EXPECT_LT(stretched.off_m, wished);
  EXPECT_NEAR(stretched.off_m, (far.translation() - stretched.X_WB.translation()).norm(), 1e-9);
  const Guidance back = settle(controller, home, 8);
  EXPECT_EQ(back.hindrance, Hindrance::none)
      << to_string(back.hindrance) << " " << back.off_m << " m " << back.off_rad << " rad";
}

TEST_P(ControllerOf, StaysAboveTheTable) {
  Controller controller(model, on_a_table(model));
  Pose below = arm::end_pose(model, model.home);
  below.translation().z() = -0.3;
  const Guidance end = settle(controller, below);
  EXPECT_GT(end.X_WB.translation().z(), 0);
  EXPECT_GT(end.off_m, 0.1);
  EXPECT_NE(end.hindrance, Hindrance::none);
}

TEST_P(ControllerOf, AnswersTheSameEachTime) {
  Controller first(model, on_a_table(model)), second(model, on_a_table(model));
  test::Operator a(model, 3), b(model, 3);
  for (int frame = 0; frame < 100; ++frame) {
    const auto [wish, step] = a.next();
    const auto [same, again] = b.next();
    EXPECT_EQ(first.step(wish, step).q, second.step(same, again).q);
  }
}

TEST_P(ControllerOf, BrakesForAWishThatCannotBeMeant) {
  Controller controller(model, on_a_table(model));
  Pose X_WB = arm::end_pose(model, model.home);
  X_WB.translation().x() += 0.2;
  for (int k = 0; k < 20; ++k) controller.step(resting(X_WB), dt);
  X_WB.translation().x() = std::numeric_limits<double>::quiet_NaN();
  Guidance end;
  for (int k = 0; k < 100; ++k) end = controller.step(resting(X_WB), dt);
  EXPECT_EQ(end.hindrance, Hindrance::no_wish);
  EXPECT_EQ(end.velocity.norm(), 0);
}

INSTANTIATE_TEST_SUITE_P(Arms, ControllerOf, testing::ValuesIn(test::arm_names()));

// Through the wrist's singularity: joint 5 of the Puma goes from one sign to the other. The hand
// may lag while joints are damped, and is where it is wished in the end.
TEST(Controller, PassesASingularWrist) {
  const model::ArmModel& puma = test::arm("puma560");
  Joints q = puma.home;
  q[4] = 0.5;
  Controller controller(puma, {});
  controller.start(q);
  double worst = 0;
  Guidance end;
  for (int k = 0; k <= 300; ++k) {
    Joints wished = q;
    wished[4] = 0.5 - std::min(k, 200) * 0.005;
    end = controller.step(resting(arm::end_pose(puma, wished)), dt);
    worst = std::max(worst, end.off_rad);
  }
  EXPECT_EQ(end.hindrance, Hindrance::none) << end.off_m << " " << end.off_rad;
  EXPECT_LT(worst, 0.2);
}

// A hand that moves evenly is followed more closely when its velocity is told.
TEST(Controller, TheVelocityOfTheWishIsLed) {
  const model::ArmModel& model = test::arm("offset_wrist");
  double lag[2] = {0, 0};
  for (const bool told : {false, true}) {
    Controller controller(model, {});
    const Pose home = arm::end_pose(model, model.home);
    for (int k = 1; k <= 80; ++k) {
      arm::Wish wish{home, arm::Vector6::Zero()};
      wish.X_WB.translation().z() += 0.2 * k * dt;
      if (told) wish.velocity_W[2] = 0.2;
      lag[told ? 1 : 0] = controller.step(wish, dt).off_m;
    }
  }
  EXPECT_LT(lag[1], 0.5 * lag[0]);
}

}  // namespace
