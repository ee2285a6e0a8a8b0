// Planned grasps answer a hand from the side that they were planned for, however the object is
// turned; whoever knows an object by its name gets all that are sure; and what is nonsense is
// refused whole.
#include "common/model/grasp_candidates.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "tests/support/planned_grasp.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;

const HandModel& barrett() {
  return test::hand("barrett");
}

const Shape can{ShapeKind::cylinder, {0.03, 0.03, 0.15}};
const Shape brick{ShapeKind::box, {0.04, 0.08, 0.16}};

Pose turned(double angle) {
  return make_pose(Vector3d::Zero(),
                   Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix());
}

using test::grasp_along;
using test::planned_grasp;

class GraspCandidatesTest : public testing::Test {
 protected:
  CandidateBook book;
  std::string refused(const GraspCandidate& wrong) {
    const auto taken = book.observe({7, can, {planned_grasp(from_aside), wrong}}, barrett());
    return taken ? "taken" : taken.error().what;
  }
  const Pose from_aside = grasp_along(can, Vector3d::UnitX(), Vector3d::UnitY());
  const Pose from_above = grasp_along(can, -Vector3d::UnitZ(), Vector3d::UnitY());
};

TEST_F(GraspCandidatesTest, AnswerFromAnySideOfWhatIsRound) {
  ASSERT_TRUE(
      book.observe({7, can, {planned_grasp(from_aside), planned_grasp(from_above)}}, barrett()));
  for (double angle = -3; angle < 3.2; angle += 0.37)
    for (const Pose& planned : {from_aside, from_above}) {
      const Pose X_OG = turned(angle) * planned;
      const auto found = book.answer(7, can, X_OG);
      ASSERT_TRUE(found) << angle;
      EXPECT_TRUE(found->X_OG.isApprox(X_OG, 1e-9));
      EXPECT_TRUE((found->X_OG.inverse() * found->X_OR)
                      .isApprox(planned.inverse() * planned_grasp(planned).X_OR, 1e-9))
          << "it stands in its approach as it was planned";
    }
}

TEST_F(GraspCandidatesTest, AreKeptOfAThousandObjectsAndOfThemAnew) {
  for (std::uint32_t track = 0; track < 1000; ++track)
    ASSERT_TRUE(book.observe({track, can, {}}, barrett())) << track;
  EXPECT_TRUE(book.observe({999, can, {planned_grasp(from_aside)}}, barrett()));
  const auto beyond = book.observe({1000, can, {}}, barrett());
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().what, "grasp candidates of too many objects");
}

TEST_F(GraspCandidatesTest, OfABoxAnswerFromBothEndsAndNotFromOthers) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  const Pose along_y = grasp_along(brick, y, x);
  ASSERT_TRUE(book.observe({7, brick, {planned_grasp(along_y)}}, barrett()));
  EXPECT_TRUE(book.answer(7, brick, along_y));
  const auto other_end = book.answer(7, brick, grasp_along(brick, -y, -x));
  ASSERT_TRUE(other_end);
  EXPECT_TRUE(other_end->X_OG.isApprox(turned(std::numbers::pi) * along_y, 1e-9));
  EXPECT_FALSE(book.answer(7, brick, grasp_along(brick, x, y)));
  EXPECT_FALSE(book.answer(7, brick, grasp_along(brick, -Vector3d::UnitZ(), x)));
  EXPECT_FALSE(book.answer(7, brick, grasp_along(brick, y, -x))) << "the palm upside down";
}

TEST_F(GraspCandidatesTest, PullTheHandToWhereTheyWerePlanned) {
  const Pose X_OG = grasp_along(brick, -Vector3d::UnitZ(), Vector3d::UnitX());
  ASSERT_TRUE(book.observe({7, brick, {planned_grasp(X_OG)}}, barrett()));
  Pose beside = X_OG;
  beside.translation().y() += 0.015;
  const auto found = book.answer(7, brick, beside);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->X_OG.isApprox(X_OG, 1e-9));
}

TEST_F(GraspCandidatesTest, TheOneWithTheMostRoomAnswers) {
  ASSERT_TRUE(book.observe(
      {7, can, {planned_grasp(from_aside, 0.2), planned_grasp(from_aside, 0.9)}}, barrett()));
  EXPECT_EQ(book.answer(7, can, from_aside)->room, 0.9);
}

// A grasp that stands few small errors leaves the answer to the network.
TEST_F(GraspCandidatesTest, UnsureOnesDoNotAnswer) {
  ASSERT_TRUE(book.observe({7, can, {planned_grasp(from_aside, 0.5)}}, barrett()));
  EXPECT_FALSE(book.answer(7, can, from_aside));
}

TEST_F(GraspCandidatesTest, OfAnotherObjectOrQuiteAnotherSizeDoNotAnswer) {
  ASSERT_TRUE(book.observe({7, can, {planned_grasp(from_aside)}}, barrett()));
  EXPECT_FALSE(book.answer(8, can, from_aside));
  Shape other = can;
  other.size *= 1.1;
  EXPECT_TRUE(book.answer(7, other, from_aside)) << "a camera that errs";
  other.size *= 1.6;
  EXPECT_FALSE(book.answer(7, other, from_aside));
  other = {ShapeKind::box, 2 * can.size};
  EXPECT_FALSE(book.answer(7, other, from_aside));
  book.remove(7);
  EXPECT_FALSE(book.answer(7, can, from_aside));
}

TEST_F(GraspCandidatesTest, NonsenseIsRefusedAndWhatWasKnownStays) {
  ASSERT_TRUE(book.observe({7, can, {planned_grasp(from_aside, 0.75)}}, barrett()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  GraspCandidate wrong = planned_grasp(from_above);
  wrong.dof.resize(3);
  EXPECT_EQ(refused(wrong), "grasp candidate of another hand");
  wrong = planned_grasp(from_above);
  wrong.preshape[1] = nan;
  EXPECT_EQ(refused(wrong), "grasp candidate of another hand");
  wrong = planned_grasp(from_above);
  wrong.dof[2] = 9;
  EXPECT_EQ(refused(wrong), "grasp candidate beyond the hand's limits");
  wrong = planned_grasp(from_above);
  wrong.X_OR.translation().z() = nan;
  EXPECT_EQ(refused(wrong), "grasp candidate not finite");
  wrong = planned_grasp(from_above, nan);
  EXPECT_EQ(refused(wrong), "grasp candidate not finite");
  wrong = planned_grasp(from_above);
  wrong.X_OR.translation().x() += 0.1;
  EXPECT_EQ(refused(wrong), "grasp candidate away from its approach");
  wrong = planned_grasp(from_above);
  wrong.X_OR = wrong.X_OR * turned(0.5);
  EXPECT_EQ(refused(wrong), "grasp candidate away from its approach");
  for (const double far : {nan, -0.1, 0.51}) {
    wrong = planned_grasp(from_above);
    wrong.follow_through = far;
    EXPECT_EQ(refused(wrong), "grasp candidate follows through too far") << far;
  }
  EXPECT_EQ(book.answer(7, can, from_aside)->room, 0.75);
}

TEST_F(GraspCandidatesTest, OfANameAreAllThatAreSureTheSurestFirst) {
  ASSERT_TRUE(book.observe({7, can, {}, "Can"}, barrett())) << "not searched yet";
  ASSERT_TRUE(book.observe(
      {8,
       can,
       {planned_grasp(from_aside, 0.9), planned_grasp(from_above), planned_grasp(from_aside, 0.5)},
       "Can"},
      barrett()));
  ASSERT_TRUE(book.observe({9, brick, {planned_grasp(from_above)}, "Brick"}, barrett()));
  const auto found = book.of("Can", can);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].room, 0.9);
  EXPECT_TRUE(found[1].X_OG.isApprox(from_above));
  EXPECT_TRUE(book.of("Cup", can).empty());
  EXPECT_TRUE(book.of("Can", brick).empty()) << "it is said to be quite another";
  book.remove(8);
  EXPECT_TRUE(book.of("Can", can).empty());
}

TEST_F(GraspCandidatesTest, ARoundThingIsTakenFromAnySideABoxFromItsEnds) {
  const auto round = turned_to(can, planned_grasp(from_aside), turned(1.1) * from_aside);
  EXPECT_TRUE(round.X_OG.isApprox(turned(1.1) * from_aside, 1e-9));
  EXPECT_TRUE(round.X_OR.isApprox(turned(1.1) * planned_grasp(from_aside).X_OR, 1e-9));
  const Pose end = grasp_along(brick, Vector3d::UnitY(), Vector3d::UnitX());
  EXPECT_TRUE(turned_to(brick, planned_grasp(end), turned(1.1) * end).X_OG.isApprox(end, 1e-9));
  EXPECT_TRUE(turned_to(brick, planned_grasp(end), turned(2.1) * end)
                  .X_OG.isApprox(turned(std::numbers::pi) * end, 1e-9));
}

}  // namespace
}  // namespace prehend::model
