// grasp/candidates as a book takes it: whole, or refused where it is of another kind of hand or has
// poses that are none.
#include "common/convert/grasp_candidates.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/convert/convert.hpp"
#include "tests/support/hands.hpp"

namespace prehend::convert {
namespace {

v2::GraspCandidates message() {
  v1::GraspCandidate grasp;
  grasp.X_OG(to_message(make_pose({0, 0, 0.02})));
  grasp.X_OR(to_message(make_pose({0, 0.01, 0.02})));
  grasp.preshape({0.1, 0.2, 0.3, 0.4});
  grasp.dof({0.1, 1.2, 1.3, 1.4});
  grasp.closing({0, 1, 1, 1});
  grasp.room(0.75);
  v2::GraspCandidates made;
  made.track(7);
  made.model("barrett");
  made.object("Cup");
  made.shape(to_message(model::ShapeKind::cylinder));
  made.size(to_message(Eigen::Vector3d(0.04, 0.04, 0.1)));
  made.candidates({grasp});
  made.follow_through({0.25});
  return made;
}

TEST(GraspCandidatesMessage, SaysAllThatABookKeeps) {
  const auto made = from_message(message(), test::hand("barrett"));
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(made->track, 7u);
  EXPECT_EQ(made->object, "Cup");
  EXPECT_EQ(made->shape.kind, model::ShapeKind::cylinder);
  EXPECT_EQ(made->shape.size.z(), 0.1);
  ASSERT_EQ(made->candidates.size(), 1u);
  const model::GraspCandidate& grasp = made->candidates.front();
  EXPECT_EQ(grasp.X_OG.translation().y(), 0);
  EXPECT_EQ(grasp.X_OR.translation().y(), 0.01);
  EXPECT_EQ(grasp.preshape[3], 0.4);
  EXPECT_EQ(grasp.dof[1], 1.2);
  EXPECT_EQ(grasp.closing[0], 0);
  EXPECT_EQ(grasp.room, 0.75);
  EXPECT_EQ(grasp.follow_through, 0.25);
}

// Those of older recordings do not say how far fingers go on.
TEST(GraspCandidatesMessage, ThatSaysNothingOfFollowThroughMeansAllOfIt) {
  v2::GraspCandidates older = message();
  older.follow_through({});
  const auto made = from_message(older, test::hand("barrett"));
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(made->candidates.front().follow_through, model::full_follow_through);
}

TEST(GraspCandidatesMessage, OfAnotherHandOrWithoutAPoseIsRefused) {
  v2::GraspCandidates other = message();
  other.model("dlr");
  const auto refused = from_message(other, test::hand("barrett"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what, "grasp candidates of another hand");
  v2::GraspCandidates broken = message();
  broken.candidates()[0].X_OR().position().x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(from_message(broken, test::hand("barrett")));
  v2::GraspCandidates more = message();
  more.follow_through({0.1, 0.2});
  EXPECT_EQ(from_message(more, test::hand("barrett")).error().what,
            "follow-through of other grasp candidates");
}

}  // namespace
}  // namespace prehend::convert
