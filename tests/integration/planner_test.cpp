// What is seen gets grasps: the real process answers each detection on grasp/candidates, the first
// ones before it has searched all, forgets what is gone, survives nonsense, and knows the next time
// what it searched once.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/model/placement.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/hands.hpp"

namespace prehend::integration {
namespace {

class Planner : public Rig {
 protected:
  // What other runs have found is not known here.
  Planner() { ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1); }

  stage::Process start_planner(const std::string& hand = "parallel_jaw") {
    return start("planner", {"mapping.hand=" + hand});
  }
  v1::ObjectDetection seen(std::uint32_t track, const model::Shape& shape) {
    v1::ObjectDetection message;
    message.track(track);
    message.sequence_number(++frames_);
    message.stamp_ns(now_ns());
    message.name("thing");
    message.shape(convert::to_message(shape.kind));
    message.size(convert::to_message(shape.size));
    message.X_WO(convert::to_message(make_pose({0.1, 0.2, model::half_extents(shape).z()})));
    message.probability(0.9);
    return message;
  }
  /// Shows it as a camera does until something complete is known of it; all that was told.
  std::vector<v2::GraspCandidates> told_of(const v1::ObjectDetection& object, double limit_s = 60) {
    std::vector<v2::GraspCandidates> told;
    EXPECT_TRUE(eventually(limit_s, [&] {
      v1::ObjectDetection now = object;
      now.sequence_number(++frames_);
      now.stamp_ns(now_ns());
      detections_.write(now);
      for (const auto& sample : candidates_.take())
        if (!sample.info.gone && sample.data.track() == object.track()) told.push_back(sample.data);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return !told.empty() && told.back().complete();
    }));
    return told;
  }

  const model::Shape cube_{model::ShapeKind::box, {0.04, 0.04, 0.06}};
  dds::Reader<v2::GraspCandidates> candidates_ = reader(dds::grasp_candidates);
  dds::Writer<v1::ObjectDetection> detections_ = writer(dds::object_detection);
  std::uint64_t frames_ = 0;
};

TEST_F(Planner, AnswersWhatIsSeenAndForgetsWhatIsGone) {
  const auto planner = start_planner();
  const auto told = told_of(seen(3, cube_));
  ASSERT_FALSE(told.empty());
  const v2::GraspCandidates& last = told.back();
  EXPECT_EQ(last.hand().to_string(), "hand");
  EXPECT_EQ(last.model().to_string(), "parallel_jaw");
  EXPECT_EQ(last.object().to_string(), "thing");
  EXPECT_GT(last.mass(), 0);
  ASSERT_FALSE(last.candidates().empty()) << last.reason().to_string();
  EXPECT_EQ(last.follow_through().size(), last.candidates().size());
  double room = 1;
  for (const v1::GraspCandidate& candidate : last.candidates()) {
    EXPECT_EQ(candidate.dof().size(), test::hand("parallel_jaw").dofs().size());
    EXPECT_LE(candidate.room(), room) << "the surest first";
    EXPECT_NE(candidate.grasp_type(), v1::GRASP_PRECISION) << "no finger of two jaws rests";
    room = candidate.room();
  }

  v1::ObjectDetection gone;
  gone.track(3);
  ASSERT_TRUE(detections_.dispose(gone));
  EXPECT_TRUE(eventually(10, [&] {
    for (const auto& sample : candidates_.take())
      if (sample.info.gone && sample.data.track() == 3) return true;
    return false;
  }));
}

// Who joins late hears what was found, and who starts anew need not search again.
TEST_F(Planner, RemembersWhatItHasSearched) {
  {
    const auto planner = start_planner();
    ASSERT_FALSE(told_of(seen(1, cube_)).empty());
    auto late = reader(dds::grasp_candidates);
    EXPECT_TRUE(
        hear<v2::GraspCandidates>(late, 10, [](const auto& told) { return told.complete(); }));
  }
  const auto again = start_planner();
  const auto told = told_of(seen(2, cube_));
  ASSERT_EQ(told.size(), 1u) << "all at once";
  EXPECT_TRUE(told.front().complete());
}

TEST_F(Planner, NonsenseLosesNothing) {
  const auto planner = start_planner();
  meet(detections_);
  v1::ObjectDetection wrong = seen(5, cube_);
  wrong.size().x(std::numeric_limits<double>::quiet_NaN());
  detections_.write(wrong);
  wrong = seen(6, {model::ShapeKind::unknown, {1, 1, 1}});
  detections_.write(wrong);
  wrong = seen(7, {model::ShapeKind::box, {3, 3, 3}});  // a wall
  const auto wall = told_of(wrong);
  ASSERT_FALSE(wall.empty());
  EXPECT_TRUE(wall.back().candidates().empty());
  EXPECT_THAT(wall.back().reason().to_string(), testing::HasSubstr("does not fit"));
  EXPECT_FALSE(told_of(seen(8, cube_)).back().candidates().empty());
}

// `demo --mode planned` waited for ever for what is refused.
TEST_F(Planner, SaysOfWhatItDoesNotPlanForThatThereIsNothing) {
  const auto planner = start_planner();
  v1::ObjectDetection fallen = seen(3, cube_);
  const Eigen::AngleAxisd turn(1.5, Eigen::Vector3d::UnitX());
  fallen.X_WO(convert::to_message(make_pose({0.1, 0.2, 0.02}, turn.toRotationMatrix())));
  auto told = told_of(fallen);
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(told.back().candidates().empty());
  EXPECT_THAT(told.back().reason().to_string(), testing::HasSubstr("does not stand"));

  v1::ObjectDetection doubtful = seen(4, cube_);
  doubtful.probability(0.55);
  told = told_of(doubtful);
  ASSERT_FALSE(told.empty());
  EXPECT_THAT(told.back().reason().to_string(), testing::HasSubstr("not probable"));

  // Surer now: that there is nothing is taken back, then there are grasps.
  doubtful.probability(0.9);
  told = told_of(doubtful);
  ASSERT_FALSE(told.empty());
  EXPECT_FALSE(told.front().complete());
  EXPECT_FALSE(told.back().candidates().empty()) << told.back().reason().to_string();
  // Less sure again, as while a hand hides it: what was found stays, also once a later picture has
  // been answered.
  doubtful.probability(0.3);
  doubtful.stamp_ns(now_ns());
  detections_.write(doubtful);
  doubtful.track(5);
  ASSERT_FALSE(told_of(doubtful).empty());
  auto late = reader(dds::grasp_candidates);
  const auto known =
      hear<v2::GraspCandidates>(late, 10, [](const auto& message) { return message.track() == 4; });
  ASSERT_TRUE(known);
  EXPECT_FALSE(known->candidates().empty());
}

TEST_F(Planner, SeveralObjectsAreSearchedInTurn) {
  const auto planner = start_planner("barrett");
  std::map<std::uint32_t, v1::ObjectDetection> objects;
  for (std::uint32_t track = 1; track <= 3; ++track)
    objects[track] = seen(
        track, {model::ShapeKind::cylinder, {0.02 + 0.005 * track, 0.02 + 0.005 * track, 0.16}});
  std::set<std::uint32_t> some, complete;
  EXPECT_TRUE(eventually(120, [&] {
    for (auto& [track, object] : objects) {
      object.stamp_ns(now_ns());
      detections_.write(object);
    }
    for (const auto& sample : candidates_.take()) {
      if (sample.info.gone) continue;
      if (!sample.data.candidates().empty()) some.insert(sample.data.track());
      if (sample.data.complete()) {
        if (complete.empty()) {
          EXPECT_EQ(some.size(), 3u) << "each has something before one has all";
        }
        complete.insert(sample.data.track());
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return complete.size() == 3;
  }));
}

}  // namespace
}  // namespace prehend::integration
