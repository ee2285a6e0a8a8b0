// Several hands side by side in one row: each begins when all are led, its columns bear its name,
// and what is around them stands there once.
#include "services/recorder/core/dataset/hands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/recorder_dataset/lead.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

Episode from_to(int begin_ms, int end_ms) {
  return {ms(begin_ms), ms(end_ms), "carry", "", {}};
}

/// What is told of a hand before `from_ms` is left out.
RecordingLog lead_from(int from_ms, int duration_ms) {
  const RecordingLog all = lead_for(duration_ms);
  RecordingLog log;
  log.model = all.model;
  for (std::size_t i = 0; i < all.dof.times.size(); ++i) {
    const Time t = all.dof.times[i];
    if (t < ms(from_ms)) continue;
    log.command_dof.add(t, all.command_dof.values[i]);
    log.command_X_WB.add(t, all.command_X_WB.values[i]);
    log.command_object.add(t, "Cup");
    log.dof.add(t, all.dof.values[i]);
    log.X_WB.add(t, all.X_WB.values[i]);
    log.joint.add(t, all.joint.values[i]);
    log.velocity.add(t, all.velocity.values[i]);
    log.torque.add(t, all.torque.values[i]);
  }
  return log;
}

std::vector<std::string> names_of(const Rows& rows) {
  std::vector<std::string> names;
  for (const Feature& feature : rows.others) names.push_back(feature.name);
  return names;
}

TEST(Hands, StandSideBySideFromWhereAllAreLed) {
  RecordingLog left = lead_for(2000), right = lead_from(500, 2000);
  for (RecordingLog* log : {&left, &right}) log->objects["Crate"].add(ms(0), make_pose({0, 0, 1}));
  left.objects["Crate"].add(ms(490), make_pose({0, 0, 1}));
  for (int t = 0; t < 2000; t += 20) {
    left.human_fingertips.add(ms(t), Eigen::Vector3d(1, 2, 3));
    left.human_fingers = {"thumb"};
  }
  const auto rows = make_rows({{"left", &left}, {"right", &right}}, from_to(0, 2000), {.rate = 10});
  ASSERT_TRUE(rows) << rows.error().message();
  EXPECT_EQ(rows->begin, ms(500));
  ASSERT_EQ(rows->count, 16);
  ASSERT_EQ(rows->state.columns.size(), 18u);
  EXPECT_EQ(rows->state.columns[0], "left_dof0");
  EXPECT_EQ(rows->state.columns[8], "left_base.qz");
  EXPECT_EQ(rows->state.columns[9], "right_dof0");
  EXPECT_EQ(rows->action.columns, rows->state.columns);
  for (const Table* table : {&rows->state.values, &rows->action.values, &rows->rate})
    ASSERT_EQ(table->cols(), 18);
  for (Eigen::Index row = 0; row < rows->count; ++row) {
    const double t = 0.5 + 0.1 * static_cast<double>(row);
    EXPECT_NEAR(rows->action.values(row, 0), t, 1e-7);
    EXPECT_NEAR(rows->action.values(row, 9), t, 1e-7);
    EXPECT_NEAR(rows->action.values(row, 10), -t, 1e-7);
  }
  const auto names = names_of(*rows);
  EXPECT_THAT(names, Contains("left_joint_position"));
  EXPECT_THAT(names, Contains("right_joint_position"));
  EXPECT_THAT(names, Contains("left_human_fingertips"));
  EXPECT_THAT(names, Not(Contains("right_human_fingertips")));
  EXPECT_EQ(std::ranges::count(names, "object_Crate"), 1);
}

// A crate between two hands is judged of each. It is carried after that, so nothing is cut off.
TEST(Hands, WhatBothGraspIsOneEpisodeToItsEnd) {
  RecordingLog left = lead_for(9000), right = lead_from(200, 9000);
  left.judgements = {{ms(1000), "Cup", true}, {ms(3000), "Crate", true}, {ms(8000), "Cup", true}};
  right.judgements = {{ms(3200), "Crate", true}, {ms(4000), "Crate", false}};
  auto episodes = find_episodes({{"left", &left}, {"right", &right}});
  ASSERT_EQ(episodes.size(), 3u);
  EXPECT_EQ(episodes[0].end, ms(2000));
  EXPECT_EQ(episodes[1].begin, ms(2000));
  EXPECT_EQ(episodes[1].end, ms(6000));  // the other half belongs to what is grasped next
  EXPECT_EQ(episodes[1].task, "grasp Crate");
  EXPECT_EQ(episodes[1].success, false);
  EXPECT_EQ(episodes[2].end, ms(9000));
  left.judgements.pop_back();
  EXPECT_EQ(find_episodes({{"left", &left}, {"right", &right}}).back().end, ms(9000));
  right.judgements.clear();
  left.judgements.push_back({ms(4000), "Crate", true});
  EXPECT_EQ(find_episodes({{"left", &left}, {"right", &right}}).size(), 3u) << "of one hand alone";
}

TEST(Hands, OfOneAloneAreAsBefore) {
  const RecordingLog log = lead_for(1000);
  const auto one = make_rows({{"left", &log}}, from_to(0, 1000), {.rate = 10});
  const auto as_before = make_rows(log, from_to(0, 1000), {.rate = 10});
  ASSERT_TRUE(one && as_before);
  EXPECT_EQ(one->state.columns, as_before->state.columns);
  EXPECT_EQ(one->state.values, as_before->state.values);
  EXPECT_EQ(names_of(*one), names_of(*as_before));
}

TEST(Hands, EpisodesAreThoseInWhichAllAreLed) {
  RecordingLog left = lead_for(3000), right = lead_from(1000, 4000);
  const std::vector<HandLog> both{{"left", &left}, {"right", &right}};
  auto episodes = find_episodes(both);
  ASSERT_EQ(episodes.size(), 1u);
  EXPECT_EQ(episodes[0].begin, ms(1000));
  EXPECT_EQ(episodes[0].end, ms(3000));
  EXPECT_EQ(episodes[0].success, std::nullopt);

  left.judgements.push_back({ms(1500), "Cup", true});
  right.judgements.push_back({ms(2500), "Talc", false});
  episodes = find_episodes(both);
  ASSERT_EQ(episodes.size(), 2u);
  EXPECT_EQ(episodes[0].success, true);
  EXPECT_EQ(episodes[1].success, false);
}

TEST(Hands, ThatAreNeverLedTogetherHaveNoEpisode) {
  const RecordingLog left = lead_for(500), right = lead_from(1000, 2000);
  EXPECT_TRUE(find_episodes({{"left", &left}, {"right", &right}}).empty());
  const auto rows = make_rows({{"left", &left}, {"right", &right}}, from_to(0, 500), {.rate = 10});
  ASSERT_FALSE(rows);
  EXPECT_THAT(rows.error().what, HasSubstr("right: "));
}

// Each hand waits for its object, and while it does the other one's object has not been told of for
// too long.
TEST(Hands, WhoseObjectsAreToldInTurnsHaveNoCommonBegin) {
  RecordingLog left = lead_for(5000), right = lead_for(5000);
  for (const int t : {300, 2500}) left.objects["Cup"].add(ms(t), Pose::Identity());
  left.objects["Box"].add(ms(900), Pose::Identity());
  for (const int t : {-500, 1800}) right.objects["Crate"].add(ms(t), Pose::Identity());
  const auto rows = make_rows({{"left", &left}, {"right", &right}}, from_to(0, 5000), {.rate = 10});
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().message(),
            "what is told of its hands has no time in common (export each hand by itself: --hand "
            "NAME)");
}

}  // namespace
}  // namespace prehend::recorder::dataset
