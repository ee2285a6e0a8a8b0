// What a hand feels is what the world does to it: forces on all links bear what is held, each is
// what the contact says, and a surface that slides is felt to slide as it does.
#include <gtest/gtest.h>

#include "common/grasping/world.hpp"
#include "tests/support/hands.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

const model::HandModel& barrett() {
  return test::hand("barrett");
}

const Body talc{"Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};

void run(World& world, double time) {
  for (double t = 0; t < time; t += world.time_step()) world.step();
}

/// From the side, closed and squeezing, without a table; it has borne the body for a second.
std::unique_ptr<World> holding(const Body& body) {
  const Eigen::Matrix3d R = model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  const Pose X_WB = make_pose(Vector3d(0, 0, 0.36), R) * barrett().X_BG().inverse();
  auto world = std::move(*World::create(barrett(), X_WB, VectorXd::Zero(4),
                                        {.table = false, .gravity_W = Vector3d::Zero()}));
  EXPECT_TRUE(world->add_body(body, make_pose(Vector3d(0, 0, 0.35))));
  VectorXd closed(4);
  closed << 0, 1.4, 1.4, 1.4;
  EXPECT_TRUE(world->command(X_WB, closed));
  run(*world, 1.5);
  world->set_gravity(Vector3d(0, 0, -9.81));
  run(*world, 1);
  return world;
}

TEST(Touch, ForcesOnTheHandBearTheWeightOfWhatItHolds) {
  auto world = holding(talc);
  // The solver's forces jump about their mean.
  Vector3d sum_W = Vector3d::Zero();
  constexpr int steps = 100;
  for (int i = 0; i < steps; ++i) {
    world->step();
    for (const Touch& touch : world->touches()) sum_W += touch.force_W / steps;
  }
  const double weight = talc.mass * 9.81;
  EXPECT_NEAR(sum_W.z(), -weight, 0.05 * weight);
  EXPECT_LT(sum_W.head<2>().norm(), 0.05 * weight);
}

TEST(Touch, IsTheContactSeenFromTheHand) {
  auto world = holding(talc);
  const auto contacts = world->contacts(0);
  const auto touches = world->touches();
  ASSERT_EQ(touches.size(), contacts.size());
  ASSERT_GE(touches.size(), 3U);
  const Eigen::Matrix3d R_WO = world->body_motion(0).X_WO.linear();
  for (std::size_t i = 0; i < touches.size(); ++i) {
    EXPECT_EQ(barrett().links()[static_cast<std::size_t>(touches[i].link)].name, contacts[i].link);
    EXPECT_EQ(touches[i].body, 0);
    EXPECT_LT((touches[i].normal_W + R_WO * contacts[i].normal_O).norm(), 1e-9);
    EXPECT_NEAR(touches[i].force_W.dot(touches[i].normal_W), contacts[i].force, 1e-9);
    EXPECT_NEAR(touches[i].slip_W.dot(touches[i].normal_W), 0, 1e-9);
    EXPECT_LT(touches[i].slip_W.norm(), 0.005) << "it is held, and slides";
  }
}

TEST(Touch, SlipIsHowFastTheObjectSlides) {
  auto world = holding(talc);
  world->set_gravity(Vector3d(0, 0, -400));  // more than the fingers' friction bears
  double falls = 0;
  for (int i = 0; i < 50 && falls > -0.1; ++i) {
    world->step();
    falls = world->body_motion(0).velocity.z();
  }
  ASSERT_LE(falls, -0.1);
  const auto touches = world->touches();
  ASSERT_FALSE(touches.empty());
  for (const Touch& touch : touches) EXPECT_NEAR(touch.slip_W.z(), falls, 0.3 * std::abs(falls));
}

/// A link's velocity is how its place changes: held against an object that stands still, slip is
/// the link's own motion.
TEST(Touch, SlipCountsTheFingersOwnMotion) {
  auto world = holding(talc);
  Pose X_WB = world->base();
  constexpr double speed = 0.1;  // m/s, upwards, with what it holds
  for (int i = 0; i < 100; ++i) {
    X_WB.translation().z() += speed * world->time_step();
    ASSERT_TRUE(world->command(X_WB, world->commanded_dof(), Vector3d(0, 0, speed)));
    world->step();
  }
  ASSERT_NEAR(world->body_motion(0).velocity.z(), speed, 0.02);
  for (const Touch& touch : world->touches()) EXPECT_LT(touch.slip_W.norm(), 0.02);
}

}  // namespace
}  // namespace prehend::grasping
