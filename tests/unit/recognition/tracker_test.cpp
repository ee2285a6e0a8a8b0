// A track keeps its number and, while the object stands still, a pose steadier than the sightings.
#include "services/recognition/core/detection/tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::recognition {
namespace {

using std::numbers::pi;

Sighting box_at(double x, double y, double yaw = 0) {
  Sighting made;
  made.name = "box";
  made.shape = {model::ShapeKind::box, {0.04, 0.2, 0.1}};
  made.at = TablePose{x, y, yaw};
  return made;
}
Time at(double s) {
  return Time(seconds(s));
}

TEST(Tracker, SteadyObjectGetsASteadyPose) {
  Tracker tracker;
  Random random(1);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    const auto tracks = tracker.update(
        at(0.1 * i),
        {box_at(0.1 + random.normal(0.001), random.normal(0.001), random.normal(0.01))});
    ASSERT_EQ(tracks.size(), 1u);
    EXPECT_EQ(tracks[0].id, 1u);
    if (i < 20) continue;
    EXPECT_FALSE(tracks[0].moving);
    worst = std::max(worst, std::abs(tracks[0].seen.at->x - 0.1));
  }
  EXPECT_LT(worst, 0.0012);  // sigma 1 mm over a memory of 12 pictures: 0.21 mm, five sigma
}

TEST(Tracker, MovedObjectKeepsItsNumberAndIsFollowedAtOnce) {
  Tracker tracker;
  tracker.update(at(0), {box_at(0, 0)});
  tracker.update(at(0.1), {box_at(0, 0)});
  const auto tracks = tracker.update(at(0.2), {box_at(0.05, 0)});
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].id, 1u);
  EXPECT_TRUE(tracks[0].moving);
  EXPECT_DOUBLE_EQ(tracks[0].seen.at->x, 0.05);
}

TEST(Tracker, BoxSeenFromBehindDoesNotFlip) {
  Tracker tracker;
  tracker.update(at(0), {box_at(0, 0, pi / 2 - 0.01)});
  const auto tracks = tracker.update(at(0.1), {box_at(0, 0, -pi / 2 + 0.01)});
  EXPECT_FALSE(tracks[0].moving);
  EXPECT_NEAR(tracks[0].seen.at->yaw, pi / 2, 0.011);
}

TEST(Tracker, GoneAfterHalfASecond) {
  Tracker tracker;
  tracker.update(at(0), {box_at(0, 0)});
  EXPECT_TRUE(tracker.expire(at(0.5)).empty());
  EXPECT_EQ(tracker.expire(at(0.51)), std::vector<std::uint32_t>{1});
  EXPECT_TRUE(tracker.tracks().empty());
  EXPECT_EQ(tracker.update(at(0.6), {box_at(0, 0)})[0].id, 2u);
}

TEST(Tracker, TwoOfANameStayApart) {
  Tracker tracker;
  tracker.update(at(0), {box_at(0, 0), box_at(0.3, 0)});
  const auto tracks = tracker.update(at(0.1), {box_at(0.301, 0), box_at(0.001, 0)});
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].id, 2u);
  EXPECT_EQ(tracks[1].id, 1u);
}

}  // namespace
}  // namespace prehend::recognition
