// What several recordings become together.
#include "services/recorder/tools/dataset/gather.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/recorder_dataset_files/written_recording.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GatherTest : public ::testing::Test {
 protected:
  /// Two seconds of a hand that grasps; `objects` stand still on the table.
  std::string record(const std::string& name, const std::string& model,
                     const std::vector<std::string>& objects, bool held,
                     const std::vector<std::string>& hands = {"hand"}) {
    const auto path = scratch_ / name;
    WrittenRecording file(path);
    for (int t = 0; t <= 2000; t += 50) {
      for (const std::string& hand : hands) {
        file.command(t, hand, {0.1, 0.2}, model);
        v1::HandState state;
        state.hand(hand);
        state.model(model);
        state.dof({0.1, 0.2});
        state.X_WB().orientation().w(1);
        file.write(dds::robot_state, t, state);
      }
      for (const std::string& object : objects) {
        v1::ObjectState body;
        body.body(object);
        body.X_WO().orientation().w(1);
        body.X_WO().position().x(static_cast<double>(object.size()));
        file.write(dds::object_state, t, body);
      }
    }
    v1::GraspReport report;
    report.hand(hands.back());
    report.object(objects.front());
    report.held(held);
    file.write(dds::grasp_report, 1500, report);
    file.close();
    return path.string();
  }

  static Expected<Gathered> gather_all(const std::vector<std::string>& sources,
                                       const std::vector<std::string>& hands = {}) {
    return gather(
        {.sources = sources, .format = "aloha", .output = "x", .rate = 10, .hands = hands});
  }

  const testing::Scratch scratch_;
};

TEST_F(GatherTest, ObjectsOfOtherNamesStandUnderOne) {
  const auto all = gather_all({record("a.mcap", "nobodys", {"Cup", "Box"}, true),
                               record("b.mcap", "nobodys", {"Bottle", "Box"}, false)});
  ASSERT_TRUE(all) << all.error().message();
  EXPECT_TRUE(all->passed_by.empty());
  const auto& episodes = all->dataset.episodes;
  ASSERT_EQ(episodes.size(), 2u);
  EXPECT_EQ(episodes[0].episode.task, "grasp Cup");
  EXPECT_EQ(episodes[0].episode.success, true);
  EXPECT_EQ(episodes[1].episode.success, false);
  EXPECT_TRUE(episodes[0].simulated);
  EXPECT_THAT(all->left_out, ElementsAre("object_Bottle", "object_Cup"));
  ASSERT_EQ(episodes[0].rows.others.size(), 2u);
  EXPECT_EQ(episodes[0].rows.others[0].name, "object");
  EXPECT_EQ(episodes[0].rows.others[0].values(0, 0), 3);  // where the cup stands
  EXPECT_EQ(episodes[1].rows.others[0].values(0, 0), 6);  // where the bottle does
  EXPECT_EQ(episodes[1].rows.others[1].name, "object_Box");
}

TEST_F(GatherTest, HandsOfDifferentKindsDoNotMix) {
  const auto all = gather_all(
      {record("a.mcap", "nobodys", {"Cup"}, true), record("b.mcap", "others", {"Cup"}, true)});
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().exit, exit_wrong_use);
  EXPECT_THAT(all.error().message(), HasSubstr("b.mcap: its hand is others, that of the others"));
}

TEST_F(GatherTest, SeveralHandsStandInOneRowInTheOrderAskedFor) {
  const std::string both = record("both.mcap", "nobodys", {"Cup"}, true, {"left", "right"});
  const auto unclear = gather_all({both});
  ASSERT_FALSE(unclear);
  EXPECT_THAT(unclear.error().message(), HasSubstr("holds several hands: left, right"));
  for (const std::vector<std::string>& order :
       {std::vector<std::string>{"left", "right"}, {"right", "left"}}) {
    const auto all = gather_all({both}, order);
    ASSERT_TRUE(all) << all.error().message();
    EXPECT_EQ(all->dataset.hand, "nobodys+nobodys");
    ASSERT_EQ(all->dataset.episodes.size(), 1u);
    EXPECT_EQ(all->dataset.episodes[0].episode.success, true);  // judged of the right hand
    const auto& columns = all->dataset.episodes[0].rows.state.columns;
    ASSERT_EQ(columns.size(), 18u);
    EXPECT_EQ(columns[0], order[0] + "_dof0");
    EXPECT_EQ(columns[9], order[1] + "_dof0");
  }
  const auto none = gather_all({both}, {"left", "third"});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message(), HasSubstr("holds no hand third but left, right"));
}

TEST_F(GatherTest, OneThatCannotBeUsedIsPassedBy) {
  WrittenRecording mute(scratch_ / "mute.mcap");
  mute.close();
  const auto all =
      gather_all({(scratch_ / "mute.mcap").string(), record("a.mcap", "nobodys", {"Cup"}, true)});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->dataset.episodes.size(), 1u);
  ASSERT_EQ(all->passed_by.size(), 1u);
  EXPECT_THAT(all->passed_by[0].message(), HasSubstr("mute.mcap"));
  const std::string mutes = (scratch_ / "mute.mcap").string();
  EXPECT_FALSE(gather_all({mutes}));
  const auto none = gather_all({mutes, mutes});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().exit, exit_no);
  EXPECT_THAT(none.error().message(),
              HasSubstr("mute.mcap: no episode in any of these recordings ("));
}

}  // namespace
}  // namespace prehend::recorder::dataset
