// Ways of an arm among things on a table. What is drawn is looked at by brute force: points on all
// surfaces, at postures between which nothing moves by more than 2 mm. The planner keeps 10 mm and
// looks every 10 mm, so that 5 mm are left in between; 1 mm more is for the spline of the corners.
#include "common/planning/plan.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/random.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/planning/tables.hpp"

using namespace prehend;
using namespace prehend::planning;
using Eigen::Vector3d;

namespace {

constexpr double kept = 0.004, look = 0.002;  // m

int scenes() {
  return std::getenv("PREHEND_LONG") ? 500 : 40;
}

void expect_within_limits(const Robot& robot, const Trajectory& trajectory) {
  constexpr double dt = 0.004;
  arm::Joints before = trajectory.at(0), now = trajectory.at(0);
  for (double t = dt; t < trajectory.duration() + 3 * dt; t += dt) {
    const arm::Joints next = trajectory.at(t);
    EXPECT_TRUE(arm::is_within_limits(*robot.arm, next));
    for (Eigen::Index j = 0; j < next.size(); ++j) {
      const auto& joint = robot.arm->joints[static_cast<std::size_t>(j)];
      EXPECT_LE(std::abs(next[j] - now[j]) / dt, joint.velocity) << joint.name << " at " << t;
      EXPECT_LE(std::abs(next[j] - 2 * now[j] + before[j]) / (dt * dt), joint.acceleration)
          << joint.name << " at " << t;
    }
    before = now;
    now = next;
  }
}

void expect_arrives(const Robot& robot, const Query& query, const Trajectory& trajectory) {
  EXPECT_EQ(trajectory.at(0), query.start);
  const Pose X_WB = robot.hand_at(trajectory.at(trajectory.duration()));
  EXPECT_LT((X_WB.translation() - query.X_WB.translation()).norm(), 1e-6);
  EXPECT_LT(angle_between(X_WB.linear(), query.X_WB.linear()), 1e-6);
}

/// A query to a place in the air, without anything on the table.
Query to_the_air(const Robot& robot, const Vector3d& p) {
  Query query;
  query.start = robot.arm->home;
  query.X_WB = robot.hand_at(query.start);
  query.X_WB.translation() = p;
  return query;
}

Obstacle wall(const Vector3d& size, const Vector3d& p) {
  return {{"the wall", {model::ShapeKind::box, size}, {}}, make_pose(p)};
}

TEST(Plan, EveryWayAmongThingsIsFreeWithinLimitsAndArrives) {
  const Robot robot = test::puma_with("barrett");
  int solved = 0, lost = 0;
  for (int seed = 1; seed <= scenes(); ++seed) {
    SCOPED_TRACE(seed);
    const Query query = test::drawn_reach(robot, static_cast<std::uint64_t>(seed));
    const auto made = plan(robot, query);
    if (!made) {
      lost += made.error().what.starts_with("no way");
      EXPECT_EQ(made.error().message().find('\n'), std::string::npos);
      continue;
    }
    ++solved;
    expect_arrives(robot, query, *made);
    expect_within_limits(robot, *made);
    EXPECT_GT(test::min_gap(robot, query.scene, *made, look), kept);
  }
  RecordProperty("solved", solved);
  RecordProperty("no_way", lost);
  // What cannot be reached or grasped so is refused at once; to all else there is a way.
  EXPECT_GT(solved, scenes() / 3);
  EXPECT_LE(lost, scenes() / 50);
}

TEST(Plan, WhatIsHeldStaysUprightAndTouchesNothing) {
  const Robot robot = test::puma_with("barrett");
  int solved = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(scenes()) / 2; ++seed) {
    SCOPED_TRACE(seed);
    const Query reach = test::drawn_reach(robot, seed);
    const auto there = plan(robot, reach);
    if (!there) continue;
    // Grasped, and lifted clear of all.
    Pose lifted = reach.then.front();
    lifted.translation().z() += 0.08;
    const Room room(robot, {}, {.hand_clearance = 0.001});
    const auto grasp = straight_way(robot, room, there->at(there->duration()), reach.then.front());
    if (!grasp) continue;
    const auto up = straight_way(robot, room, grasp->back(), lifted);
    if (!up) continue;
    const Query carry = test::drawn_carry(robot, reach, up->back(), seed);
    const auto made = plan(robot, carry);
    if (!made) continue;
    ++solved;
    expect_arrives(robot, carry, *made);
    expect_within_limits(robot, *made);
    EXPECT_GT(test::min_gap(robot, carry.scene, *made, look), kept);
    for (double t = 0; t < made->duration(); t += 0.01) {
      const Vector3d up_W = robot.hand_at(made->at(t)).linear() * carry.upright->up_B;
      EXPECT_LT(std::acos(std::min(1.0, up_W.z())), carry.upright->max_tilt + 0.01);
    }
  }
  EXPECT_GT(solved, scenes() / 10);
}

TEST(Plan, GoesAroundAThinWall) {
  const Robot robot = test::puma_with("barrett");
  Query query = to_the_air(robot, {0.3, -0.1, 0.35});
  const Vector3d from = robot.hand_at(query.start).translation();
  query.start = plan(robot, to_the_air(robot, {-0.3, -0.1, 0.35}))->at(1e9);
  query.scene.obstacles = {wall({0.004, 0.5, 0.5}, {0, 0.0, 0.25})};
  ASSERT_LT(from.y(), 0.2);
  const auto made = plan(robot, query);
  ASSERT_TRUE(made) << made.error().message();
  expect_arrives(robot, query, *made);
  expect_within_limits(robot, *made);
  EXPECT_GT(test::min_gap(robot, query.scene, *made, look), kept);
  // Without the wall the way is shorter, and through it.
  Query bare = query;
  bare.scene.obstacles.clear();
  const auto direct = plan(robot, bare);
  ASSERT_TRUE(direct);
  EXPECT_LT(test::min_gap(robot, query.scene, *direct, look), 0);
  EXPECT_LT(direct->duration(), made->duration());
}

TEST(Plan, IsTheSameEachTime) {
  const Robot robot = test::puma_with("barrett");
  Query query = to_the_air(robot, {0.3, -0.1, 0.35});
  query.start = plan(robot, to_the_air(robot, {-0.3, -0.1, 0.35}))->at(1e9);
  query.scene.obstacles = {wall({0.02, 0.5, 0.5}, {0, 0.0, 0.25})};
  const auto a = plan(robot, query), b = plan(robot, query);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->duration(), b->duration());
  for (double t = 0; t < a->duration(); t += 0.01) EXPECT_EQ(a->at(t), b->at(t));
}

TEST(Plan, StandsCloseToWhatItHasLetGoOf) {
  const Robot robot = test::puma_with("barrett");
  Query query = to_the_air(robot, {0.2, -0.2, 0.4});
  const Pose X_WB = robot.hand_at(query.start);
  const Vector3d tip = (X_WB * robot.hand->X_BG()).translation();
  // A ball in the middle of the open fingers: nearer to palm or fingers than the clearance.
  query.scene.obstacles = {
      {{"ball", {model::ShapeKind::sphere, Vector3d::Constant(0.02)}, {}}, make_pose(tip)}};
  Room room(robot, query.scene, {.hand_clearance = 0.2});
  ASSERT_TRUE(room.conflict(query.start));
  room.tolerate(query.start);
  EXPECT_FALSE(room.conflict(query.start));
}

TEST(Plan, FailuresAreOneClearLine) {
  const Robot robot = test::puma_with("barrett");
  const auto message = [&](const Query& query) {
    const auto made = plan(robot, query);
    EXPECT_FALSE(made);
    return made ? std::string() : made.error().message();
  };
  EXPECT_EQ(message(to_the_air(robot, {0, 2, 0.3})),
            "where the hand shall go: is out of the arm's reach");

  Query inside = to_the_air(robot, {0.1, -0.15, 0.35});
  inside.scene.obstacles = {wall({0.1, 0.1, 0.1}, {0.1, -0.15, 0.35})};
  EXPECT_NE(message(inside).find("is not free: the hand touches the wall"), std::string::npos)
      << message(inside);

  Query stuck = to_the_air(robot, {0.1, -0.15, 0.35});
  stuck.scene.obstacles = {wall({0.3, 0.3, 0.3}, robot.hand_at(stuck.start).translation())};
  EXPECT_NE(message(stuck).find("begins in a collision"), std::string::npos) << message(stuck);

  Query tilted = to_the_air(robot, {0.1, -0.15, 0.35});
  tilted.upright = Upright{robot.hand_at(tilted.start).linear().transpose() * Vector3d::UnitX()};
  EXPECT_NE(message(tilted).find("cannot begin: not upright"), std::string::npos)
      << message(tilted);

  Query around = to_the_air(robot, {0.3, -0.1, 0.35});
  around.start = plan(robot, to_the_air(robot, {-0.3, -0.1, 0.35}))->at(1e9);
  around.scene.obstacles = {wall({0.004, 0.5, 0.5}, {0, 0.0, 0.25})};
  PlanOptions no_patience;
  no_patience.search.max_iterations = 0;
  EXPECT_NE(plan(robot, around, no_patience).error().message().find("no way found in 0 tries"),
            std::string::npos);

  Query wild = to_the_air(robot, {0.1, -0.15, 0.35});
  wild.start[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(wild).find("not usable"), std::string::npos);

  // Under the table there is no room, and straight on is the table.
  Query down = to_the_air(robot, {0.0, -0.15, 0.35});
  Pose below = down.X_WB;
  below.translation().z() = -0.3;
  down.then = {below};
  EXPECT_NE(message(down).find("cm straight on"), std::string::npos) << message(down);
}

TEST(Room, AgreesWithBruteForceAtDrawnPostures) {
  const Robot robot = test::puma_with("barrett");
  Random random(5);
  int touching = 0, apart = 0;
  for (int n = 0; n < 500; ++n) {
    const Query query = test::drawn_reach(robot, static_cast<std::uint64_t>(n));
    const Room room(robot, query.scene, {.clearance = 0.001, .hand_clearance = 0.001});
    const arm::Joints q =
        robot.arm->home + 0.8 * (test::random_posture(*robot.arm, random) - robot.arm->home);
    Trajectory standing = timed(robot, {q}, {});
    const double gap = test::min_gap(robot, query.scene, standing, look);
    const auto conflict = room.conflict(q);
    if (gap < -0.001) {
      EXPECT_TRUE(conflict) << n << " " << gap;
      ++touching;
    }
    // Points miss some: edges that cross, and what only the arm's own rules know.
    if (conflict && conflict->first != "the arm" && conflict->distance > 0) {
      EXPECT_LT(gap, 0.012) << n << " " << conflict->message();
    }
    apart += !conflict;
  }
  EXPECT_GT(touching, 5);
  EXPECT_GT(apart, 10);
}

}  // namespace
