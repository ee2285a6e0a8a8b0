// Which parts of a recording are episodes: the rule in episodes.hpp, case by case.
#include "services/recorder/core/dataset/episodes.hpp"

#include <gtest/gtest.h>

#include "tests/unit/recorder_dataset/lead.hpp"

namespace prehend::recorder::dataset {
namespace {

TEST(Episodes, NoneWithoutCommands) {
  RecordingLog log;
  log.judgements = {{ms(100), "Cup", true}};
  EXPECT_TRUE(find_episodes(log).empty());
}

TEST(Episodes, AllOfItWhereNothingWasJudged) {
  const auto episodes = find_episodes(lead_for(4000));
  ASSERT_EQ(episodes.size(), 1u);
  EXPECT_EQ(episodes[0].begin, ms(0));
  EXPECT_EQ(episodes[0].end, ms(4000));
  EXPECT_EQ(episodes[0].task, "grasp Cup");
  EXPECT_FALSE(episodes[0].success);
}

TEST(Episodes, OneAJudgedGrasp) {
  RecordingLog log = lead_for(9000);
  log.judgements = {{ms(2000), "Cup", true}, {ms(2600), "Talc", false}, {ms(7000), "Cup", true}};
  const auto episodes = find_episodes(log);
  ASSERT_EQ(episodes.size(), 3u);
  EXPECT_EQ(episodes[0].begin, ms(0));
  EXPECT_EQ(episodes[0].end, ms(2300));  // the next judgement comes before the tail is over
  EXPECT_EQ(episodes[1].begin, ms(2300));
  EXPECT_EQ(episodes[1].end, ms(3600));
  EXPECT_EQ(episodes[2].begin, ms(3600));
  EXPECT_EQ(episodes[2].end, ms(8000));
  EXPECT_EQ(episodes[0].success, true);
  EXPECT_EQ(episodes[1].success, false);
  EXPECT_EQ(episodes[1].task, "grasp Talc");
  EXPECT_EQ(episodes[1].object, "Talc");
}

// Reports are transient local: that of a grasp before stands at the beginning.
TEST(Episodes, NotAGraspOfBefore) {
  RecordingLog log = lead_for(3000);
  log.judgements = {{ms(-5), "Cup", true}, {ms(2000), "Cup", false}};
  const auto episodes = find_episodes(log);
  ASSERT_EQ(episodes.size(), 1u);
  EXPECT_EQ(episodes[0].success, false);
}

TEST(Episodes, ATaskIsOneHoweverManyGraspsItHas) {
  RecordingLog log = lead_for(9000);
  log.judgements = {{ms(2000), "Cup", true}, {ms(5000), "Talc", true}};
  log.runs = {{ms(1000), ms(6000), "TEA", false}};
  const auto episodes = find_episodes(log);
  ASSERT_EQ(episodes.size(), 1u);
  EXPECT_EQ(episodes[0].begin, ms(1000));
  EXPECT_EQ(episodes[0].end, ms(6000));
  EXPECT_EQ(episodes[0].task, "TEA");
  EXPECT_EQ(episodes[0].success, false);  // the performer judged it, not the grasps
}

TEST(Episodes, ADemonstrationSucceedsWhereAllItsGraspsHeld) {
  RecordingLog log = lead_for(9000);
  log.judgements = {{ms(500), "Cup", false},  // in none of them
                    {ms(2000), "Cup", true},
                    {ms(5000), "Talc", true},
                    {ms(5500), "Cup", false}};
  log.shown = {{ms(1000), ms(3000), "TEA", {}},
               {ms(4000), ms(6000), "TEA", {}},
               {ms(7000), ms(8000), "TEA", {}}};
  const auto episodes = find_episodes(log);
  ASSERT_EQ(episodes.size(), 3u);
  EXPECT_EQ(episodes[0].success, true);
  EXPECT_EQ(episodes[1].success, false);
  EXPECT_FALSE(episodes[2].success);
}

}  // namespace
}  // namespace prehend::recorder::dataset
