// What is taken of a recording for training data. The recordings are written here, message by
// message, as the recorder writes them.
#include "services/recorder/tools/dataset/read_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "tests/unit/recorder_dataset_files/written_recording.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ReadLogTest : public ::testing::Test {
 protected:
  void SetUp() override { file_.emplace(path_); }

  template <class Topic, class Message>
  void write(const Topic& topic, int t, const Message& message) {
    file_->write(topic, t, message);
  }
  void command(int t, const std::string& hand, std::vector<double> dof,
               const std::string& model = "barrett") {
    file_->command(t, hand, std::move(dof), model);
  }

  Expected<ReadLog> read(const std::string& hand = "") {
    if (file_) file_->close();
    file_.reset();
    return read_log(path_, hand);
  }

  const testing::Scratch scratch_;
  const std::filesystem::path path_ = scratch_ / "a.mcap";
  std::optional<WrittenRecording> file_;
};

TEST_F(ReadLogTest, CommandsAndStates) {
  command(0, "hand", {0.1, 0.2});
  command(20, "hand", {0.3, 0.4});
  v1::HandState state;
  state.hand("hand");
  state.model("barrett");
  state.dof({0, 1});
  state.joint({0, 1, 2});
  state.velocity({3, 4, 5});
  state.torque({6, 7, 8});
  state.X_WB().position().z(0.5);
  state.X_WB().orientation().w(2);  // is made a unit quaternion
  write(dds::robot_state, 30, state);
  const auto read = this->read();
  ASSERT_TRUE(read) << read.error().message();
  const RecordingLog& log = read->log;
  EXPECT_TRUE(read->damage.empty());
  EXPECT_EQ(log.model, "barrett");
  EXPECT_THAT(log.command_dof.times, ElementsAre(ms(0), ms(20)));
  EXPECT_EQ(log.command_dof.values[1], Eigen::Vector2d(0.3, 0.4));
  EXPECT_EQ(log.command_object.values[0], "Wood cube");
  EXPECT_EQ(log.torque.values[0], Eigen::Vector3d(6, 7, 8));
  EXPECT_EQ(log.X_WB.values[0].translation(), Eigen::Vector3d(0, 0, 0.5));
  EXPECT_TRUE(log.X_WB.values[0].linear().isIdentity());
}

// A sensor that fails, or measures no pressure, must not read as a link that is not touched.
TEST_F(ReadLogTest, TouchOfTheLinksThatMeasureIt) {
  command(0, "hand", {0.1});
  const auto touch = [&](int t, const std::string& hand, bool thumb_valid) {
    v1::HandTouch message;
    message.hand(hand);
    message.model("barrett");
    for (const char* link : {"palm", "thumb", "index"}) {
      v1::PadTouch pad;
      pad.link(link);
      pad.valid(std::string(link) != "thumb" || thumb_valid);
      pad.force_B().x(t);
      pad.force_B().z(-1);
      pad.pressure(std::string(link) == "palm" ? -1 : 2);
      pad.slip(0.01);
      message.pads().push_back(pad);
    }
    write(dds::robot_touch, t, message);
  };
  touch(10, "another", true);
  touch(20, "hand", true);
  touch(30, "hand", false);
  touch(40, "hand", true);
  const auto read = this->read("hand");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(read->damage.empty());
  const RecordingLog& log = read->log;
  EXPECT_THAT(log.touch_links, ElementsAre("thumb", "index"));
  EXPECT_THAT(log.touch_force.times, ElementsAre(ms(20), ms(40)));
  EXPECT_THAT(log.touch_force.values[1], ElementsAre(40, 0, -1, 40, 0, -1));
  EXPECT_THAT(log.touch_pressure.values[0], ElementsAre(2, 2));
  EXPECT_THAT(log.touch_slip.values[0], ElementsAre(0.01, 0.01));
}

TEST_F(ReadLogTest, SeveralHandsMustBeChosenFrom) {
  command(0, "left", {0.1});
  command(0, "right", {0.2, 0.2});
  const auto both = read();
  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().exit, exit_wrong_use);
  EXPECT_THAT(both.error().what, HasSubstr("left, right"));
  const auto right = read("right");
  ASSERT_TRUE(right);
  EXPECT_EQ(right->log.command_dof.values[0].size(), 2);
  EXPECT_FALSE(read("middle"));
}

TEST_F(ReadLogTest, WhatCannotBeUsedIsCounted) {
  command(0, "hand", {0.1, 0.2});
  command(10, "hand", {std::numeric_limits<double>::quiet_NaN(), 0});
  command(20, "hand", {0.1});                  // other DoFs
  command(30, "hand", {0.1, 0.2}, "rutgers");  // another kind
  command(40, "hand", {0.5, 0.6});
  const auto read = this->read();
  ASSERT_TRUE(read);
  EXPECT_THAT(read->log.command_dof.times, ElementsAre(ms(0), ms(40)));
  ASSERT_EQ(read->damage.size(), 1u);
  EXPECT_THAT(read->damage[0].message(), HasSubstr("3 messages of robot/command cannot be used"));
}

TEST_F(ReadLogTest, NothingWithoutCommands) {
  v1::HandState state;
  state.hand("hand");
  write(dds::robot_state, 0, state);
  const auto read = this->read();
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().exit, exit_no);
  EXPECT_THAT(read.error().message(), HasSubstr("holds no command of a hand"));
}

TEST_F(ReadLogTest, TasksThatTheRobotDid) {
  command(0, "hand", {0});
  const auto progress = [&](int t, const std::string& task, v1::TaskState state,
                            const std::string& hand = "hand") {
    v1::TaskProgress message;
    message.task(task);
    message.hand(hand);
    message.state(state);
    write(dds::task_progress, t, message);
  };
  progress(5, "OTHER", v1::TASK_DONE);  // of before
  progress(10, "TEA", v1::TASK_RUNNING);
  progress(20, "TEA", v1::TASK_RUNNING);
  progress(25, "TEA", v1::TASK_FAILED, "another");
  progress(30, "TEA", v1::TASK_DONE);
  progress(40, "SORT", v1::TASK_RUNNING);
  progress(50, "SORT", v1::TASK_FAILED);
  progress(60, "TEA", v1::TASK_RUNNING);  // the recording ends before it does
  const auto read = this->read();
  ASSERT_TRUE(read);
  const auto& runs = read->log.runs;
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].begin, ms(10));
  EXPECT_EQ(runs[0].end, ms(30));
  EXPECT_EQ(runs[0].task, "TEA");
  EXPECT_EQ(runs[0].success, true);
  EXPECT_EQ(runs[1].task, "SORT");
  EXPECT_EQ(runs[1].success, false);
}

TEST_F(ReadLogTest, StatesOfAnotherHandAndTimesOfAnotherAgeAreSaid) {
  command(0, "hand", {0.1, 0.2});
  file_->write(dds::robot_command, from_ns(8'100'000'000'000'000'000), v2::HandCommand());
  v1::HandState state;
  state.hand("hand");
  state.model("barrett");
  state.dof({0, 1, 2});
  state.X_WB().orientation().w(1);
  {
    const auto read = this->read("hand");
    ASSERT_TRUE(read) << read.error().message();
    ASSERT_EQ(read->damage.size(), 1u);
    EXPECT_THAT(read->damage[0].message(), HasSubstr("1 messages of robot/command cannot be used "
                                                     "(its time is in another age)"));
  }
  std::filesystem::remove(path_);
  SetUp();
  command(0, "hand", {0.1, 0.2});
  write(dds::robot_state, 10, state);
  const auto read = this->read();
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message(),
            path_.string() + ": its robot/command and robot/state are of different hands");
}

TEST_F(ReadLogTest, DemonstrationsBetweenTheOperatorsMarks) {
  command(0, "hand", {0});
  const auto order = [&](int t, v1::OperatorAction action, const std::string& target,
                         const std::string& argument) {
    v1::OperatorCommand message;
    message.action(action);
    message.target(target);
    message.argument(argument);
    write(dds::operator_command, t, message);
  };
  order(10, v1::ACTION_START, "demonstration", "TEA");
  order(15, v1::ACTION_STOP, "recorder", "");
  order(20, v1::ACTION_STOP, "demonstration", "");
  order(30, v1::ACTION_STOP, "demonstration", "");
  const auto read = this->read();
  ASSERT_TRUE(read);
  ASSERT_EQ(read->log.shown.size(), 1u);
  EXPECT_EQ(read->log.shown[0].begin, ms(10));
  EXPECT_EQ(read->log.shown[0].end, ms(20));
  EXPECT_EQ(read->log.shown[0].task, "TEA");
}

TEST_F(ReadLogTest, FingersThatAreMeasuredInTheTablesFrame) {
  command(0, "hand", {0});
  v1::HandPosture posture;
  posture.glove("glove");
  posture.X_WH().position().x(1);
  posture.X_WH().orientation().w(1);
  for (const std::size_t finger : {0u, 4u}) {
    posture.fingertips()[finger].valid(true);
    posture.fingertips()[finger].p_HF().y(0.1);
  }
  write(dds::hand_posture, 0, posture);
  posture.fingertips()[4].valid(false);  // its sensor is lost for a while
  write(dds::hand_posture, 30, posture);
  const auto read = this->read();
  ASSERT_TRUE(read);
  EXPECT_THAT(read->log.human_fingers, ElementsAre("thumb", "little"));
  ASSERT_EQ(read->log.human_fingertips.values.size(), 1u);
  Eigen::VectorXd expected(6);
  expected << 1, 0.1, 0, 1, 0.1, 0;
  EXPECT_EQ(read->log.human_fingertips.values[0], expected);
}

TEST_F(ReadLogTest, ObjectsAsTheWorldSaysElseAsSeen) {
  command(0, "hand", {0});
  v1::ObjectDetection seen;
  seen.name("Wood cube");
  seen.X_WO().orientation().w(1);
  seen.X_WO().position().x(1);
  write(dds::object_detection, 0, seen);
  {
    const auto read = this->read();
    ASSERT_TRUE(read);
    ASSERT_TRUE(read->log.objects.contains("Wood_cube"));  // as it may stand in a path
    EXPECT_FALSE(read->log.simulated);
  }
  std::filesystem::remove(path_);
  SetUp();
  command(0, "hand", {0});
  write(dds::object_detection, 0, seen);
  v1::ObjectState there;
  there.body("Talc");
  there.X_WO().orientation().w(1);
  write(dds::object_state, 0, there);
  const auto read = this->read();
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->log.objects.contains("Wood_cube"));
  EXPECT_TRUE(read->log.objects.contains("Talc"));
  EXPECT_TRUE(read->log.simulated);
}

TEST(RecordingsOf, FilesAndFoldersByName) {
  const testing::Scratch scratch;
  std::filesystem::create_directories(scratch / "more/deep");
  for (const char* name : {"more/b.mcap", "more/deep/a.mcap", "more/notes.txt", "one.mcap"})
    testing::write_bytes(scratch / name, std::string("x"));
  const auto all = recordings_of({(scratch / "one.mcap").string(), (scratch / "more").string()});
  ASSERT_TRUE(all);
  EXPECT_THAT(*all, ElementsAre(scratch / "one.mcap", scratch / "more/b.mcap",
                                scratch / "more/deep/a.mcap"));
  EXPECT_FALSE(recordings_of({(scratch / "none").string()}));
}

}  // namespace
}  // namespace prehend::recorder::dataset
