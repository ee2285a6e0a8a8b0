// Planned grasps move the mapping: the fingers follow the person's closing along them, the palm
// comes to their place, and nothing jumps when they come and go.
#include <gtest/gtest.h>

#include "common/model/grasp_candidates.hpp"
#include "services/mapping/core/mapping.hpp"
#include "services/mapping/tools/training/closing_lessons.hpp"
#include "tests/support/planned_grasp.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;

const model::Shape can{model::ShapeKind::cylinder, {0.03, 0.03, 0.15}};

using test::grasp_along;
using test::planned_grasp;

/// A mapping with a network that knows how far people have closed, in reach of a can.
class PlannedMappingTest : public testing::Test {
 protected:
  static const MappingModel& model() {
    static const MappingModel made = [] {
      const MappingModel plain = random_model(21);
      ModelTraits traits = plain.traits();
      ClosingLessonOptions people;
      people.people = 40;
      traits.closing = train_closing(people, {.hidden = 10, .epochs = 300}).value();
      return MappingModel::create(barrett(), std::move(traits), plain.networks()).value();
    }();
    return made;
  }

  Time at(int ms) const { return Time(std::chrono::milliseconds(1'000'000 + ms)); }

  /// The robot hand is where the human one is.
  void begin(Mapping& mapping, const Pose& X_WG) const {
    const auto joints = static_cast<Eigen::Index>(barrett().joints().size());
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(joints);
    ASSERT_TRUE(mapping.on_state(
        {at(-1), barrett().postures().at("open"), none, none, X_WG * barrett().X_BG().inverse()}));
  }

  /// Commands while the hand, at X_WG, goes from one closure to another.
  Command after(Mapping& mapping, int& ms, const Pose& X_WG, double from, double to) {
    Command last;
    for (int i = 0; i < 60; ++i, ms += 33) {
      (void)mapping.on_detection({1, "can", can, X_WO, 0.95, at(ms)});
      const double c = from + (to - from) * std::min(1.0, i / 20.0);
      const Pose X_WH = X_WG * model::HumanHand(1.0).X_HG().inverse();
      const auto answer =
          mapping.on_posture({at(ms), at(ms - 3), X_WH, 1.0, tips({c, c, c, c, c})}, at(ms));
      EXPECT_TRUE(answer);
      if (answer) last = *answer;
    }
    return last;
  }

  const Pose X_WO = make_pose({0, 0, 0.075});
  const Pose X_OG = grasp_along(can, Vector3d::UnitX(), Vector3d::UnitY());
};

TEST_F(PlannedMappingTest, FingersGoFromThePreshapePastTheContactAndThePalmToItsPlace) {
  Mapping mapping = Mapping::create(barrett(), model(), {}).value();
  const model::GraspCandidate planned = planned_grasp(X_OG);
  ASSERT_TRUE(mapping.on_candidates({1, can, {planned}}));
  int ms = 0;
  const Pose X_WG = X_WO * X_OG * make_pose({0.004, -0.006, 0.005});
  begin(mapping, X_WG);
  const Command open = after(mapping, ms, X_WG, 0, 0);
  EXPECT_EQ(open.object, "can");
  EXPECT_NEAR(open.weight, 1, 1e-9);
  EXPECT_NEAR(open.dof[0], planned.preshape[0], 0.02) << "spread as planned";
  EXPECT_LT(open.dof.tail(3).maxCoeff(), 0.45) << "and open";
  EXPECT_LT(
      (open.X_WB.translation() - (X_WO * planned.X_OR * barrett().X_BG().inverse()).translation())
          .norm(),
      0.002);
  const Command closed = after(mapping, ms, X_WG, 0, 1);
  for (int i = 1; i < 4; ++i) EXPECT_GT(closed.dof[i], planned.dof[i]) << "past the contact";
  EXPECT_NEAR(closed.dof[0], planned.dof[0], 0.02) << "what does not close stays";
}

// Guards: fingers went on past every plan, and pushed out what two of them had pinched.
TEST_F(PlannedMappingTest, FingersGoOnAsFarAsThePlanSays) {
  const auto closed_with = [&](double follow_through) {
    Mapping mapping = Mapping::create(barrett(), model(), {}).value();
    model::GraspCandidate planned = planned_grasp(X_OG);
    planned.follow_through = follow_through;
    EXPECT_TRUE(mapping.on_candidates({1, can, {planned}}));
    int ms = 0;
    begin(mapping, X_WO * X_OG);
    after(mapping, ms, X_WO * X_OG, 0, 0);
    return after(mapping, ms, X_WO * X_OG, 0, 1).dof;
  };
  const double squeeze = model::full_squeeze;
  const Eigen::VectorXd none = closed_with(0), some = closed_with(0.2), all = closed_with(0.5);
  const Eigen::VectorXd contact = planned_grasp(X_OG).dof;
  for (int i = 1; i < 4; ++i) EXPECT_NEAR(none[i], contact[i] + squeeze, 1e-6) << i;
  EXPECT_NEAR((some - none).maxCoeff(), 0.2, 1e-3);
  EXPECT_GT((all - none).maxCoeff(), 0.4) << "and is still on its way";
  EXPECT_LE((all - none).maxCoeff(), model::full_follow_through);
}

TEST_F(PlannedMappingTest, WithoutCandidatesItAnswersAsBefore) {
  Mapping with = Mapping::create(barrett(), model(), {}).value();
  const MappingModel plain = random_model(21);
  Mapping without = Mapping::create(barrett(), plain, {}).value();
  ASSERT_TRUE(with.on_candidates({2, can, {planned_grasp(X_OG)}})) << "of another track";
  int ms = 0, ms_without = 0;
  begin(with, X_WO * X_OG);
  begin(without, X_WO * X_OG);
  const Command a = after(with, ms, X_WO * X_OG, 0, 0.6);
  const Command b = after(without, ms_without, X_WO * X_OG, 0, 0.6);
  EXPECT_EQ(a.dof, b.dof);
  EXPECT_EQ(a.X_WB.matrix(), b.X_WB.matrix());
}

// A camera and a planner may come and go while the hand closes: limits hold all the same.
TEST_F(PlannedMappingTest, NothingJumpsWhenCandidatesComeAndGo) {
  Mapping mapping = Mapping::create(barrett(), model(), {}).value();
  std::optional<Command> last;
  Random random(3);
  for (int ms = 0; ms < 6000; ms += 20) {
    (void)mapping.on_detection({1, "can", can, X_WO, 0.95, at(ms)});
    if (random.index(10) == 0) {
      model::GraspCandidate any = planned_grasp(X_OG);
      any.dof.tail(3) << random.uniform(0.5, 2), random.uniform(0.5, 2), random.uniform(0.5, 2);
      ASSERT_TRUE(mapping.on_candidates({1, can, {any}}));
    } else if (random.index(20) == 0) {
      mapping.on_candidates_gone(1);
    }
    const double c = 0.5 + 0.5 * std::sin(ms * 1e-3);
    const Pose X_WH = X_WO * X_OG * model::HumanHand(1.0).X_HG().inverse();
    const auto answer =
        mapping.on_posture({at(ms), at(ms), X_WH, 1.0, tips({c, c, c, c, c})}, at(ms));
    if (!answer) continue;
    if (last) {
      const double t = to_seconds(answer->stamp - last->stamp);
      for (Eigen::Index i = 0; i < 4; ++i) {
        const double most = barrett().dofs()[static_cast<std::size_t>(i)].max_velocity;
        EXPECT_LE(std::abs(answer->dof[i] - last->dof[i]), most * t + 1e-9) << ms;
      }
      EXPECT_LE((answer->X_WB.translation() - last->X_WB.translation()).norm(), 1.0 * t + 1e-9);
    }
    last = *answer;
  }
  ASSERT_TRUE(last);
}

TEST(ClosingLessons, AreTheSameForASeedAndSpanOpenToClosed) {
  ClosingLessonOptions options;
  options.people = 10;
  const auto one = closing_lessons(options), again = closing_lessons(options);
  EXPECT_EQ(one.inputs, again.inputs);
  EXPECT_EQ(one.outputs, again.outputs);
  EXPECT_GT(one.inputs.cols(), 100);
  EXPECT_EQ(one.outputs.maxCoeff(), 1);
  EXPECT_LT(one.outputs.minCoeff(), 0.1);
  options.seed = 2;
  EXPECT_NE(closing_lessons(options).outputs.size(), 0);
}

// Of people who were not there, on things whose sizes nobody trained: within 15 % of the closing.
TEST(ClosingLessons, TellOfOtherPeopleHowFarTheyHaveClosed) {
  ClosingLessonOptions options;
  const auto trained = train_closing(options, {.hidden = 16, .epochs = 600});
  ASSERT_TRUE(trained);
  EXPECT_LT(std::sqrt(trained->errors.test), 0.15);
}

}  // namespace
}  // namespace prehend::mapping
