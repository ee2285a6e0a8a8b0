// Tasks are done again in a world, by the performer that also moves a robot's hand: objects come to
// where they shall be, whatever stands where at the beginning; and what cannot be done is said.
#include "services/performer/core/rehearsal/rehearsal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/arm/mounting.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/preshapes.hpp"
#include "common/model/placement.hpp"
#include "services/demonstration/tools/trials/trial.hpp"
#include "services/performer/core/reproduction/alike.hpp"
#include "services/performer/tools/trials/lab_things.hpp"
#include "services/performer/tools/trials/trial.hpp"
#include "tests/unit/performer/fixtures.hpp"

namespace prehend::performer {
namespace {

using testing::HasSubstr;

TEST(Rehearsal, PutsAnObjectToItsPlaceOnTheTable) {
  const std::vector<Thing> things{thing("Talc", 0.1, 0.05), thing("Carton box", -0.4, 0.3)};
  const auto made = rehearse(
      barrett(), put("Talc", tasks::the_table, {-0.1, -0.1, things[0].X_WO.translation().z()}),
      things, resting());
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_LT(made->verdicts[0].error, 0.005);  // it was 1 to 5 cm when opening fingers pushed it
  EXPECT_LT(made->verdicts[0].turn, 0.17);
  EXPECT_LT(made->verdicts[0].max_tilt, 0.26);
}

TEST(Rehearsal, PutsAnObjectBesideAnother) {
  const std::vector<Thing> things{thing("Cup", -0.1, 0.1), thing("Carton box", 0.25, 0.2)};
  const double lower = things[0].X_WO.translation().z() - things[1].X_WO.translation().z();
  const auto made =
      rehearse(barrett(), put("Cup", "Carton box", {0.0, -0.3, lower}), things, resting());
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_LT(made->verdicts[0].error, 0.005);
}

TEST(GraspCandidates, ThePersonsComesFirstAndEachPoseMeetsEachPreshapeOnce) {
  const model::Shape& cube = objects().find("Wood cube")->shape;
  const auto made = grasp_candidates(barrett(), cube, from_the_side());
  const auto preshapes = grasping::preshapes_of(barrett());
  const Pose persons = model::nearest_grasp(cube, from_the_side(), barrett().reach()).value() *
                       barrett().X_BG().inverse();
  ASSERT_FALSE(made.empty());
  EXPECT_TRUE(made.front().X_OB.isApprox(persons));
  EXPECT_EQ(made.front().preshape, preshapes.front());
  std::map<std::size_t, std::size_t> with;  // how many poses with each preshape
  for (std::size_t i = 0; i < made.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_FALSE(made[i].X_OB.isApprox(made[k].X_OB, 1e-6) &&
                   made[i].preshape == made[k].preshape)
          << i << " and " << k;
    const auto found = std::find(preshapes.begin(), preshapes.end(), made[i].preshape);
    ASSERT_NE(found, preshapes.end());
    ++with[static_cast<std::size_t>(found - preshapes.begin())];
  }
  EXPECT_EQ(with.size(), preshapes.size());
  for (const auto& [preshape, poses] : with) EXPECT_EQ(poses, made.size() / preshapes.size());
}

TEST(GraspCandidates, WhatIsLowIsAlsoTakenLower) {
  const auto heights = [](const char* name) {
    std::set<int> made;  // mm
    for (const RobotGrasp& each :
         grasp_candidates(barrett(), objects().find(name)->shape, from_the_side())) {
      const Pose X_OG = each.X_OB * barrett().X_BG();
      if (X_OG.linear().col(2).z() < -0.99)
        made.insert(static_cast<int>(std::lround(1000 * X_OG.translation().z())));
    }
    return made;
  };
  EXPECT_EQ(heights("Wood cube").size(), 2u);
  EXPECT_EQ(heights("Talc").size(), 1u) << "the table is far";
}

TEST(Rehearsal, FindsAPreshapeForWhatTheOpenHandCannotHold) {
  // Two fingers of the open Barrett hand stand farther apart than the cube is wide; turned aside by
  // 15 degrees they hold it.
  const std::vector<Thing> things{thing("Wood cube", 0.1, 0.05)};
  const tasks::TaskModel task = put("Wood cube", tasks::the_table, {-0.1, -0.1, 0.0215});
  const auto made = rehearse(barrett(), task, things, resting());
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_LT(made->verdicts[0].error, 0.02);
  EXPECT_GT(made->grasps[0].preshape[0], 0.2) << "the fingers are spread";
}

TEST(Rehearsal, SaysWhatCannotBeDone) {
  const std::vector<Thing> things{thing("Carton box", 0.1, 0.05)};
  const auto absent =
      rehearse(barrett(), put("Talc", tasks::the_table, {0, 0, 0.05}), things, resting());
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().message(), HasSubstr("Talc: is not in this lab"));
  const auto nowhere =
      rehearse(barrett(), put("Carton box", "Teapot", {0, 0, 0.05}), things, resting());
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message(), HasSubstr("Teapot: is not in this lab"));
}

TEST(TaskPerformer, NeedsAllThatTheTaskNames) {
  const Thing talc = thing("Talc", 0.1, 0.05);
  const Shapes shapes = shapes_of({talc});
  const Places places{{"Talc", talc.X_WO}};
  const auto said = [&](const Shapes& known, const Places& there, std::size_t grasps) {
    const auto made =
        TaskPerformer::create(barrett(), put("Talc", tasks::the_table, {0, 0, 0.0525}), known,
                              there, std::vector<RobotGrasp>(grasps), resting());
    return made ? std::string("taken") : made.error().message();
  };
  EXPECT_EQ(said(shapes, places, 2), "put: needs a grasp for each step");
  EXPECT_EQ(said(shapes, {}, 1),
            "Talc: is not in this lab, and the task put needs it (put it in the camera's sight, or "
            "into the scene (lab.scene))");
  EXPECT_EQ(said({}, places, 1), "Talc: has no known shape");
}

TEST(TaskPerformer, IsNotWaitedForLongerThanItMayTake) {
  const Thing talc = thing("Talc", 0.1, 0.05);
  auto world = grasping::World::create(barrett(), resting().X_WB, resting().dof).value();
  ASSERT_TRUE(world->add_body(talc.body, talc.X_WO));
  auto performer = TaskPerformer::create(
      barrett(), put("Talc", tasks::the_table, {0, 0, 0.0525}), shapes_of({talc}),
      places_of(*world), {grasp_candidates(barrett(), talc.body.shape, from_the_side()).front()},
      resting());
  ASSERT_TRUE(performer) << performer.error().message();
  EXPECT_EQ(perform_in(*world, *performer, 0.05).error().what, "takes longer than it should");
}

TEST(LabThings, OfASceneAreThoseOfTheCatalogue) {
  const auto bodies = grasping::CatalogueBodies::create(objects()).value();
  model::Scene scene;
  scene.objects = {{"Talc", Pose::Identity()}};
  EXPECT_EQ(LabThings(barrett(), bodies, false).of(scene)->size(), 1u);
  scene.objects.push_back({"Teapot", Pose::Identity()});
  EXPECT_EQ(LabThings(barrett(), bodies, false).of(scene).error().message(),
            "Teapot: is not in the catalogue");
}

TEST(TaskPerformer, FailsWhereTheObjectDoesNotComeAlong) {
  // A world in which the object is nailed to the table.
  Thing nailed = thing("Talc", 0.1, 0.05);
  nailed.body.mass = 0;
  const auto made = rehearse(barrett(), put("Talc", tasks::the_table, {-0.1, -0.1, 0.0525}),
                             {nailed}, resting(), {.max_tries = 1});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message(), HasSubstr("lift: was not lifted"));
}

// Fingers that closed from above crept on, pulled a cylinder up and turned it by 41° in the hand.
TEST(StepPerformer, WhatClosingFingersRaiseIsInTheHand) {
  const HandGoal from = resting();
  Pose X_WO = thing("Talc", 0.1, 0.05).X_WO;
  Eigen::VectorXd dof = from.dof;
  const StepOrder order{
      .object = "Talc", .grasp = {make_pose({0, 0, 0.2}), from.dof}, .X_WO_goal = X_WO};
  StepPerformer performer(barrett(), order, from, {});
  double closing = 0;  // s
  for (int n = 0; n < 3000 && performer.part() != StepPart::lift; ++n) {
    performer.step(
        {Time(seconds(0.01 * n)), performer.goal().X_WB, dof, barrett().joint_angles(dof)}, X_WO);
    if (performer.part() != StepPart::close) continue;
    closing += 0.01;
    dof.tail(3).array() += 0.001;
    X_WO.translation().z() += 0.0001;
  }
  EXPECT_EQ(performer.part(), StepPart::lift);
  EXPECT_LT(closing, 0.6);
  EXPECT_FALSE(performer.failure());
}

/// The Puma with Barrett's hand, where the configuration's defaults have it.
planning::Robot puma() {
  static const model::ArmModel arm = model::ArmModel::load(model::arm_directory("puma560")).value();
  const Eigen::AngleAxisd turn(EIGEN_PI / 2, Eigen::Vector3d::UnitZ());
  return {&arm, &barrett(), make_pose({0, -0.7, 0}, turn.toRotationMatrix()),
          arm.X_EF * arm::mounted(barrett(), 0.7)};
}

RehearsalOptions by_arm(const planning::Robot& robot) {
  RehearsalOptions options;
  options.robot = robot;
  options.posture = robot.arm->home;
  return options;
}

TEST(Rehearsal, AnArmPutsAnObjectToItsPlaceAndGoesHome) {
  const planning::Robot robot = puma();
  const std::vector<Thing> things{thing("Talc", 0.1, -0.05), thing("Cup", -0.2, 0.05)};
  const HandGoal from{robot.hand_at(robot.arm->home), barrett().postures().at("open")};
  const tasks::TaskModel task =
      put("Talc", tasks::the_table, {0.15, -0.25, things[0].X_WO.translation().z()});
  const auto made = rehearse(barrett(), task, things, from, by_arm(robot));
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_LT(made->verdicts[0].error, 0.02);
  EXPECT_LT(made->verdicts[0].max_tilt, 0.26);

  // The same in a world, to the end.
  auto world = grasping::World::create(barrett(), from.X_WB, from.dof).value();
  for (const Thing& each : things) ASSERT_TRUE(world->add_body(each.body, each.X_WO));
  auto arm = arm_of(robot, robot.arm->home).value();
  auto performer = TaskPerformer::create(barrett(), task, shapes_of(things), places_of(*world),
                                         made->grasps, from, {}, {}, {robot});
  ASSERT_TRUE(performer);
  ASSERT_TRUE(perform_in(*world, *performer, 60, arm.get()));
  EXPECT_TRUE(performer->done()) << performer->reason();
  EXPECT_LT((arm->posture() - robot.arm->home).cwiseAbs().maxCoeff(), 0.05);
}

TEST(Rehearsal, WhatAnArmDoesNotReachIsSaidBeforeItMoves) {
  const planning::Robot robot = puma();
  const std::vector<Thing> things{thing("Talc", 0.1, -0.05)};
  const HandGoal from{robot.hand_at(robot.arm->home), barrett().postures().at("open")};
  const auto far = [&](double x, double y) {
    const std::vector<Thing> there{thing("Talc", x, y)};
    return rehearse(barrett(), put("Talc", tasks::the_table, {0, -0.2, 0.05}), there, from,
                    by_arm(robot));
  };
  const auto made = far(0.1, 1.5);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message(), HasSubstr("approach: is out of the arm's reach"));
  // Within reach, but its place is not: it is taken, and put back.
  RehearsalOptions once = by_arm(robot);
  once.max_tries = 1;
  const auto back =
      rehearse(barrett(), put("Talc", tasks::the_table, {0.1, 1.5, 0.05}), things, from, once);
  ASSERT_FALSE(back);
  EXPECT_THAT(back.error().message(), HasSubstr("carry: is out of the arm's reach"));
}

TEST(TaskTrial, WhatWasShownOnceIsUnderstoodAndDoneElsewhere) {
  const auto shown = demonstration::show_task(barrett(), objects(), 1, 1);
  ASSERT_TRUE(shown) << shown.error().message();
  EXPECT_TRUE(shown->understood);
  std::vector<Thing> things;
  for (const model::PlacedObject& placed : shown->again.objects) {
    const model::CatalogueObject& known = *objects().find(placed.name);
    things.push_back({{known.name, known.shape, known.mass, known.material, {}, {}}, placed.X_WO});
  }
  const TaskTrial trial = try_task(barrett(), shown->task, things, 1);
  EXPECT_TRUE(trial.rehearsed) << trial.reason;
  EXPECT_TRUE(trial.done) << trial.reason;
  EXPECT_LT(trial.max_error, 0.02);
}

TEST(Alike, OfACylinderOnlyTheAxisShowsOfABoxHalfTurnsDoNot) {
  using Eigen::AngleAxisd;
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  const Matrix3d goal = Matrix3d::Identity();
  const Matrix3d yaw = AngleAxisd(1.0, Vector3d::UnitZ()).toRotationMatrix();
  const Matrix3d roll = AngleAxisd(0.3, Vector3d::UnitX()).toRotationMatrix();
  const Matrix3d half = AngleAxisd(3.1, Vector3d::UnitZ()).toRotationMatrix();
  const model::Shape cylinder{model::ShapeKind::cylinder, {0.03, 0.03, 0.1}};
  const model::Shape box{model::ShapeKind::box, {0.03, 0.05, 0.1}};
  const model::Shape sphere{model::ShapeKind::sphere, {0.03, 0.03, 0.03}};
  EXPECT_NEAR(visible_turn(cylinder, yaw, goal), 0, 1e-6);
  EXPECT_NEAR(visible_turn(cylinder, roll * yaw, goal), 0.3, 1e-6);
  EXPECT_NEAR(visible_turn(box, yaw, goal), 1.0, 1e-6);
  EXPECT_NEAR(visible_turn(box, half, goal), M_PI - 3.1, 1e-6);
  EXPECT_NEAR(visible_turn(sphere, roll, goal), 0, 1e-6);
}

}  // namespace
}  // namespace prehend::performer
