// What prehend-planner has found is what the performer tries first, closed as it was judged; where
// it does not do the task, or nothing is planned, the performer finds a grasp of its own.
#include <gtest/gtest.h>

#include "common/grasping/catalogue_bodies.hpp"
#include "services/performer/core/rehearsal/rehearsal.hpp"
#include "services/performer/tools/trials/lab_things.hpp"
#include "tests/unit/performer/fixtures.hpp"

namespace prehend::performer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double squeeze = 0.15;  // rad, of Barrett's fingers

Pose turned(double angle, const Pose& X) {
  return Pose(Eigen::AngleAxisd(angle, Vector3d::UnitZ())) * X;
}

/// One finger of Barrett's three rests, another has twice the way of the third.
model::GraspCandidate planned_at(const Pose& X_OG) {
  model::GraspCandidate made;
  made.X_OG = made.X_OR = X_OG;
  made.preshape = Vector4d(0.3, 0.2, 0.2, 0.2);
  made.dof = Vector4d(0.3, 1.2 - squeeze, 2.2 - squeeze, 0.2);
  made.closing = Vector4d(0, 1, 1, 0);
  made.room = 0.9;
  return made;
}

Pose from_above() {
  return make_pose({0, 0, 0.04}, model::grasp_axes(-Vector3d::UnitZ(), Vector3d::UnitX()));
}

TEST(PlannedGrasps, ComeFromNearThePersonFirstAndFromEachSideThatLooksTheSameOnce) {
  const Pose X_BG = barrett().X_BG();
  const std::vector<model::GraspCandidate> planned{planned_at(from_above()),
                                                   planned_at(turned(2, from_the_side()))};
  const model::Shape& round = objects().find("Talc")->shape;
  const auto made = planned_grasps(barrett(), round, from_the_side(), planned);
  ASSERT_EQ(made.size(), 16u) << "eight turns of each";
  EXPECT_TRUE((made[0].X_OB * X_BG).isApprox(from_the_side(), 1e-9)) << "turned to the person";
  EXPECT_NEAR((made[1].X_OB * X_BG).linear()(2, 2), -1, 1e-9) << "then the other one";
  for (const RobotGrasp& each : made) {
    EXPECT_TRUE(each.planned);
    EXPECT_EQ(each.preshape, planned[0].preshape);
  }
  const model::Shape& box = objects().find("Carton box")->shape;
  EXPECT_EQ(planned_grasps(barrett(), box, from_the_side(), {planned[0]}).size(), 2u)
      << "of a box two ends";
  EXPECT_TRUE(planned_grasps(barrett(), round, from_the_side(), {}).empty());
}

// As the planner judges: fingers arrive together, however different their ways, and what rests
// rests.
TEST(StepPerformer, ClosesAPlannedGraspInProportion) {
  const auto grasp = planned_grasps(barrett(), objects().find("Talc")->shape, from_above(),
                                    {planned_at(from_above())})
                         .front();
  ASSERT_TRUE(grasp.closing.isApprox(Vector4d(0, 1, 2, 0), 1e-9));
  const Pose X_WO = thing("Talc", 0, 0).X_WO;
  StepPerformer performer(barrett(), {.object = "Talc", .grasp = grasp, .X_WO_goal = X_WO},
                          resting(), {});
  Eigen::VectorXd dof = resting().dof;
  double closing = 0;  // s
  for (int n = 0; n < 3000 && closing < 1; ++n) {
    performer.step(
        {Time(seconds(0.01 * n)), performer.goal().X_WB, dof, barrett().joint_angles(dof)}, X_WO);
    dof = performer.goal().dof;  // nothing is in the way
    closing += performer.part() == StepPart::close ? 0.01 : 0;
  }
  ASSERT_EQ(performer.part(), StepPart::close);
  EXPECT_EQ(dof[0], 0.3);
  EXPECT_EQ(dof[3], 0.2) << "it rests";
  EXPECT_NEAR(dof[2] - 0.2, 2 * (dof[1] - 0.2), 1e-6);
  EXPECT_NEAR(dof[2] - 0.2, 0.8, 0.03) << "the one with the longest way as fast as it may";
}

const grasping::CatalogueBodies& bodies() {
  static const auto made = grasping::CatalogueBodies::create(objects()).value();
  return made;
}

TEST(Rehearsal, TakesWhatThePlannerFound) {
  const model::Scene scene{.objects = {{"Talc", make_pose({0.1, 0.05, 0.0525})}}};
  LabThings without(barrett(), bodies(), false), with(barrett(), bodies(), true);
  ASSERT_TRUE(without.of(scene)->front().planned.empty());
  const auto things = with.of(scene);
  ASSERT_TRUE(things) << things.error().message();
  ASSERT_FALSE(things->front().planned.empty());
  const tasks::TaskModel task = put("Talc", tasks::the_table, {-0.1, -0.1, 0.0525});
  const auto made = rehearse(barrett(), task, *things, resting());
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_TRUE(made->grasps[0].planned);
  EXPECT_TRUE(made->verdicts[0].planned);
  EXPECT_LT(made->verdicts[0].error, 0.005);
}

TEST(Rehearsal, FindsItsOwnWhereWhatIsPlannedDoesNotDoIt) {
  Thing talc = thing("Talc", 0.1, 0.05);
  talc.planned = {planned_at(make_pose({0, 0, 0.3}, from_above().linear()))};  // into the air
  const tasks::TaskModel task = put("Talc", tasks::the_table, {-0.1, -0.1, 0.0525});
  const auto made = rehearse(barrett(), task, {talc}, resting());
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_FALSE(made->verdicts[0].planned);
  const auto alone = rehearse(barrett(), task, {thing("Talc", 0.1, 0.05)}, resting());
  ASSERT_TRUE(alone);
  EXPECT_TRUE(made->grasps[0].X_OB.isApprox(alone->grasps[0].X_OB)) << "as without a planner";
}

}  // namespace
}  // namespace prehend::performer
