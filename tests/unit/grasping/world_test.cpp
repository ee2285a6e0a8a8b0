// What the physical world must keep to whatever happens in it: the table carries, limits hold, the
// same calls give the same bits, nonsense is refused and leaves the world unharmed.
#include "common/grasping/world.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/base/file_text.hpp"
#include "common/grasping/hold_test.hpp"
#include "common/model/hand_effort.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;

const model::HandModel& barrett() {
  return test::hand("barrett");
}

const Body talc{"Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};
const Body cube{"Cube", {model::ShapeKind::box, {0.043, 0.043, 0.043}}, 0.05, "wood", {}};

Pose standing(const Body& body, double x = 0, double y = 0) {
  return make_pose(Vector3d(x, y, model::half_extents(body.shape).z()));
}

/// From the side: the palm looks along y of W and its x axis points up, as does the object's axis.
Pose side_grasp(const Vector3d& p_WG) {
  const Eigen::Matrix3d R = model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  return make_pose(p_WG, R) * barrett().X_BG().inverse();
}

TEST(World, RefusesAHandOfUnknownMaterial) {
  const std::string folder = test::in_sources("common/models/hands/barrett/");
  std::string toml = *read_file(folder + "hand.toml");
  const std::string known = "palm = \"plastic\"";
  ASSERT_NE(toml.find(known), std::string::npos);
  toml.replace(toml.find(known), known.size(), "palm = \"cheese\"");
  const auto hand = model::HandModel::parse(*read_file(folder + "hand.urdf"), toml);
  ASSERT_TRUE(hand) << hand.error().message();
  const auto world = World::create(*hand, Pose::Identity(), VectorXd::Zero(4));
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().message(),
            "palm: unknown material cheese (glass, metal, plastic, wood, rubber or stone)");
}

std::unique_ptr<World> empty_world(const Pose& X_WB) {
  auto world = World::create(barrett(), X_WB, VectorXd::Zero(4));
  if (!world) throw std::runtime_error(world.error().message());
  return std::move(*world);
}

void run(World& world, double time) {
  for (double t = 0; t < time; t += world.time_step()) world.step();
}

/// Talc on the table, the hand about it, closed and squeezing.
std::unique_ptr<World> gripped(const Body& body, const Vector3d& offset = Vector3d::Zero()) {
  const Pose X_WB = side_grasp(Vector3d(0, 0, 0.06) + offset);
  auto world = empty_world(X_WB);
  if (!world->add_body(body, standing(body))) throw std::runtime_error("not added");
  VectorXd closed(4);
  closed << 0, 1.4, 1.4, 1.4;
  world->command(X_WB, closed);
  run(*world, 1.5);
  return world;
}

TEST(World, TheTableCarriesWhatStandsOnIt) {
  auto world = empty_world(make_pose(Vector3d(0, 0, 1)));
  ASSERT_TRUE(world->add_body(talc, standing(talc)));
  ASSERT_TRUE(world->add_body(cube, standing(cube, 0.3)));
  run(*world, 2);
  for (int i = 0; i < 2; ++i) {
    const Pose start = standing(world->body(i), 0.3 * i);
    const BodyMotion motion = world->body_motion(i);
    EXPECT_LT((motion.X_WO.translation() - start.translation()).norm(), 5e-4);
    EXPECT_LT(angle_between(motion.X_WO.linear(), start.linear()), 0.01);
    EXPECT_LT(motion.velocity.norm(), 1e-3);
    EXPECT_TRUE(world->touches_others(i));
    EXPECT_TRUE(world->contacts(i).empty());
  }
  EXPECT_FALSE(world->hand_touches_anything());
}

TEST(World, AFreeBodyFalls) {
  auto world = empty_world(make_pose(Vector3d(0, 0, 3)));
  ASSERT_TRUE(world->add_body(cube, make_pose(Vector3d(0.5, 0, 1))));
  run(*world, 0.2);
  // s = g t²/2 = 0.196 m; the integrator is of first order, its error g t dt/2 = 2 mm.
  EXPECT_NEAR(world->body_motion(0).X_WO.translation().z(), 1 - 0.1962, 0.004);
}

TEST(World, HandAndFingersKeepToTheirLimits) {
  const Pose start = make_pose(Vector3d(0, 0, 0.5));
  auto world = empty_world(start);
  Pose goal = make_pose(Vector3d(0.4, -0.3, 0.9),
                        Eigen::AngleAxisd(2, Vector3d(1, 2, 3).normalized()).toRotationMatrix());
  world->command(goal, VectorXd::Constant(4, 1.2));
  Pose last = start;
  for (int i = 0; i < 1500; ++i) {
    world->step();
    const HandMotion motion = world->hand_motion();
    const Vector3d com = barrett().links()[0].com_L;
    EXPECT_LE((motion.X_WB * com - last * com).norm(), 1.0 * world->time_step() * 1.001);
    EXPECT_LE(angle_between(motion.X_WB.linear(), last.linear()), 3.0 * world->time_step() * 1.01);
    for (std::size_t k = 0; k < barrett().joints().size(); ++k) {
      const auto& joint = barrett().joints()[k];
      const double speed = barrett().dofs()[static_cast<std::size_t>(joint.dof)].max_velocity;
      EXPECT_LE(std::abs(motion.velocity[static_cast<Eigen::Index>(k)]),
                speed * std::abs(joint.multiplier) * 1.02);
      EXPECT_LE(std::abs(motion.torque[static_cast<Eigen::Index>(k)]), joint.max_torque * 1.0001);
    }
    last = motion.X_WB;
  }
  EXPECT_LT((last.translation() - goal.translation()).norm(), 1e-4);
  EXPECT_LT(angle_between(last.linear(), goal.linear()), 1e-3);
  EXPECT_LT((world->hand_motion().dof - VectorXd::Constant(4, 1.2)).norm(), 2e-3);
  EXPECT_LT(
      (world->hand_motion().joint - barrett().joint_angles(VectorXd::Constant(4, 1.2))).norm(),
      2e-3);
}

TEST(World, AClosedHandLiftsAndHolds) {
  auto world = gripped(talc);
  EXPECT_GE(world->contacts(0).size(), 3u);
  for (const analysis::Contact& contact : world->contacts(0)) {
    EXPECT_EQ(contact.friction, 1.0);  // rubber on plastic
    EXPECT_GT(contact.force, 0);
    EXPECT_LT(contact.depth, 0.001);
    EXPECT_NEAR(contact.normal_O.norm(), 1, 1e-9);
    EXPECT_LT(std::abs(model::signed_distance(talc.shape, contact.p_OC)), 0.002);
    // Into the object: towards the axis.
    EXPECT_LT(contact.normal_O.dot(Vector3d(contact.p_OC.x(), contact.p_OC.y(), 0)), 0);
  }
  const HoldResult result = hold_test(*world->clone(), 0);
  EXPECT_TRUE(result.held) << result.reason;
  EXPECT_LT(result.slip, 0.01);
}

TEST(World, WhatIsSlipperyIsNotHeld) {
  Body slippery = talc;
  slippery.friction = 0.05;
  const HoldResult result = hold_test(*gripped(slippery)->clone(), 0);
  EXPECT_FALSE(result.held);
  EXPECT_FALSE(result.reason.empty());
}

TEST(World, WhatTheHandMissesIsNotHeld) {
  const auto world = gripped(talc, Vector3d(0.10, 0, 0));
  const HoldResult result = hold_test(*world->clone(), 0);
  EXPECT_FALSE(result.held);
}

TEST(World, SameCallsGiveSameBits) {
  const auto first = gripped(talc), second = gripped(talc);
  EXPECT_EQ(first->hand_motion().joint, second->hand_motion().joint);
  EXPECT_EQ(first->hand_motion().torque, second->hand_motion().torque);
  EXPECT_TRUE(
      (first->body_motion(0).X_WO.matrix().array() == second->body_motion(0).X_WO.matrix().array())
          .all());
  const HoldResult a = hold_test(*first->clone(), 0), b = hold_test(*second->clone(), 0);
  EXPECT_EQ(a.slip, b.slip);
  EXPECT_EQ(a.turn, b.turn);
}

TEST(World, ACloneLeavesTheOriginalAlone) {
  const auto world = gripped(talc);
  const auto untouched = gripped(talc);
  const auto copy = world->clone();
  EXPECT_EQ(copy->hand_motion().joint, world->hand_motion().joint);
  EXPECT_EQ(copy->body_motion(0).X_WO.matrix(), world->body_motion(0).X_WO.matrix());
  // Bullet's contact memory is not copied: it is filled anew, a point a step, and the grip settles
  // once more, here by 0.6 mm.
  const auto beside = world->clone();
  const auto original = gripped(talc);
  run(*beside, 0.5);
  run(*original, 0.5);
  EXPECT_LT(
      (beside->body_motion(0).X_WO.translation() - original->body_motion(0).X_WO.translation())
          .norm(),
      1e-3);
  hold_test(*copy, 0);
  run(*world, 0.1);
  run(*untouched, 0.1);
  EXPECT_EQ(world->hand_motion().joint, untouched->hand_motion().joint);
}

TEST(World, HoldingStillKeepsTheGripAndStopsWhatMoves) {
  auto world = gripped(talc);
  world->hold_still();
  run(*world, 0.5);
  EXPECT_TRUE(hold_test(*world->clone(), 0).held);

  auto moving = empty_world(make_pose(Vector3d(0, 0, 0.5)));
  moving->command(make_pose(Vector3d(0, 0, 1.5)), VectorXd::Constant(4, 1.5));
  run(*moving, 0.3);
  moving->hold_still();
  const HandMotion then = moving->hand_motion();
  run(*moving, 1);
  // It brakes from 1 m/s at 10 m/s² and returns to where it was told to stay.
  EXPECT_LT((moving->hand_motion().X_WB.translation() - then.X_WB.translation()).norm(), 1e-3);
  EXPECT_LT((moving->hand_motion().dof - then.dof).norm(), 5e-3);
}

TEST(World, DrivesUseNoMoreEffortThanTheyMay) {
  const Pose X_WB = side_grasp(Vector3d(0, 0, 0.06));
  auto world = empty_world(X_WB);
  ASSERT_TRUE(world->add_body(talc, standing(talc)));
  const VectorXd most = model::max_effort(barrett());
  VectorXd effort = 0.1 * most;  // too little for a clutch to let go
  effort[0] = most[0];
  const auto run_and_watch = [&](World& one, double time) {
    for (double t = 0; t < time && !testing::Test::HasFailure(); t += one.time_step()) {
      one.step();
      const VectorXd torque = one.hand_motion().torque.cwiseAbs();
      for (std::size_t j = 0; j < barrett().joints().size(); ++j) {
        const model::HandJoint& joint = barrett().joints()[j];
        EXPECT_LE(torque[static_cast<Eigen::Index>(j)],
                  effort[joint.dof] / most[joint.dof] * joint.max_torque * (1 + 1e-9))
            << joint.name;
      }
    }
  };
  ASSERT_TRUE(world->limit_effort(effort));
  ASSERT_TRUE(world->command(X_WB, Eigen::Vector4d(0, 1.4, 1.4, 1.4)));
  run_and_watch(*world, 1.5);
  run_and_watch(*world->clone(), 0.1);
  EXPECT_FALSE(world->limit_effort(VectorXd::Ones(3)));
  EXPECT_FALSE(world->limit_effort(-most));
  EXPECT_FALSE(
      world->limit_effort(VectorXd::Constant(4, std::numeric_limits<double>::quiet_NaN())));
  world->hold_still();
  run_and_watch(*world, 0.1);  // until it is said anew
  EXPECT_TRUE(world->limit_effort({}));
}

TEST(World, RefusesNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(World::create(barrett(), Pose::Identity(), VectorXd::Zero(3)));
  EXPECT_FALSE(World::create(barrett(), Pose::Identity(), VectorXd::Constant(4, nan)));
  EXPECT_FALSE(World::create(barrett(), make_pose(Vector3d(nan, 0, 0)), VectorXd::Zero(4)));
  EXPECT_FALSE(World::create(barrett(), Pose::Identity(), VectorXd::Zero(4), {.rate = 0}));
  WorldOptions adrift;
  adrift.gravity_W.x() = nan;
  EXPECT_EQ(World::create(barrett(), Pose::Identity(), VectorXd::Zero(4), adrift).error().what,
            "gravity must be finite");
  auto world = empty_world(make_pose(Vector3d(0, 0, 1)));
  Body bad = talc;
  for (const double friction : {-0.1, nan}) {
    bad.friction = friction;
    EXPECT_EQ(world->add_body(bad, standing(talc)).error().what, "friction must be 0 or more");
  }
  bad = talc;
  bad.mesh.emplace();
  EXPECT_EQ(world->add_body(bad, standing(talc)).error().what, "mesh is not valid");
  bad = talc;
  bad.mass = -1;
  EXPECT_FALSE(world->add_body(bad, standing(talc)));
  bad = talc;
  bad.mass = nan;
  EXPECT_FALSE(world->add_body(bad, standing(talc)));
  bad = talc;
  bad.shape.size.x() = -0.1;
  EXPECT_FALSE(world->add_body(bad, standing(talc)));
  bad = talc;
  bad.material = "jelly";
  EXPECT_FALSE(world->add_body(bad, standing(talc)));
  EXPECT_FALSE(world->add_body(talc, make_pose(Vector3d(0, nan, 0))));
  EXPECT_EQ(world->body_count(), 0);
  run(*world, 0.1);
  EXPECT_TRUE(is_finite(world->hand_motion().X_WB));
}

TEST(World, ThousandsOfContactsAreCarriedAndTooManyBodiesRefused) {
  auto world = empty_world(make_pose(Vector3d(0, 0, 2)));
  for (int i = 0; i < 1000; ++i)
    ASSERT_TRUE(world->add_body(cube, standing(cube, 0.06 * (i % 32), 0.06 * (i / 32))));
  const auto refused = world->add_body(cube, standing(cube, -1));
  ASSERT_FALSE(refused);
  EXPECT_FALSE(refused.error().what.empty());
  for (int i = 0; i < 30; ++i) world->step();  // four contacts each
  for (int i = 0; i < 1000; i += 37) {
    EXPECT_TRUE(world->touches_others(i));
    EXPECT_LT(world->body_motion(i).velocity.norm(), 0.05);
  }
}

TEST(World, DistanceToTheHandIsThatOfTheirSurfaces) {
  // The palm's plate ends at z = 12 mm of B.
  auto world = empty_world(make_pose(Vector3d(0, 0, 1)));
  Body ball{"ball", {model::ShapeKind::sphere, Vector3d::Constant(0.01)}, 0.1, "wood", {}};
  ASSERT_TRUE(world->add_body(ball, make_pose(Vector3d(0, 0, 1.052))));
  EXPECT_NEAR(world->distance_to_hand(0), 0.03, 2e-3);
  world->move_body(0, make_pose(Vector3d(0, 0, 1.012)));
  EXPECT_LT(world->distance_to_hand(0), 0);
}

// A tube that had been dropped went on for ever, and faster and faster.
TEST(World, WhatRollsComesToRest) {
  for (const double radius : {0.02, 0.034}) {
    const Body tube{
        "Tube", {model::ShapeKind::cylinder, {radius, radius, 0.32}}, 0.2, "plastic", {}, {}};
    auto world = empty_world(make_pose(Vector3d(0, 0, 1)));
    ASSERT_TRUE(world->add_body(
        tube, make_pose(Vector3d(0, 0, radius),
                        Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitX()).toRotationMatrix())));
    world->set_gravity(Vector3d(0.5, 0, -9.81));
    run(*world, 1);
    world->set_gravity(Vector3d(0, 0, -9.81));
    double fastest = world->body_motion(0).velocity.norm();
    EXPECT_GT(fastest, 0.2);
    for (int n = 0; n < 150; ++n) {
      run(*world, 0.1);
      const double speed = world->body_motion(0).velocity.norm();
      EXPECT_LT(speed, fastest + 1e-3) << radius << " m, after " << 0.1 * n << " s";
      fastest = std::min(fastest, speed);
    }
    EXPECT_LT(fastest, 0.01) << radius;
  }
}

}  // namespace
