// Rows of an episode. Values come from lead.hpp, where everything is a straight function of time,
// so that each row's are known; fingertips are compared with those that the model says of the DoFs.
#include "services/recorder/core/dataset/rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/hands.hpp"
#include "tests/unit/recorder_dataset/lead.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::ElementsAre;

Episode episode_of(int begin_ms, int end_ms) {
  return {ms(begin_ms), ms(end_ms), "grasp", "Cup", true};
}

const Feature* find(const Rows& rows, const std::string& name) {
  for (const Feature& feature : rows.others)
    if (feature.name == name) return &feature;
  return nullptr;
}

TEST(Rows, AreAtTheRateThatIsAskedFor) {
  const RecordingLog log = lead_for(2000);
  const auto rows = make_rows(log, episode_of(0, 2000), {.rate = 30});
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->count, 61);
  for (Eigen::Index row = 0; row < rows->count; ++row) {
    const double t = static_cast<double>(row) / 30;
    EXPECT_NEAR(rows->action.values(row, 0), t, 1e-7);
    EXPECT_NEAR(rows->action.values(row, 1), -t, 1e-7);
    EXPECT_NEAR(rows->action.values(row, 2), t, 1e-7);  // base.x
    EXPECT_NEAR(rows->state.values(row, 0), t - 0.01, 1e-7);
  }
}

TEST(Rows, StateAndActionHaveTheSameColumns) {
  const auto rows = make_rows(lead_for(500), episode_of(0, 500), {.rate = 50});
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->state.columns, rows->action.columns);
  EXPECT_THAT(rows->state.columns, ElementsAre("dof0", "dof1", "base.x", "base.y", "base.z",
                                               "base.qw", "base.qx", "base.qy", "base.qz"));
  EXPECT_EQ(rows->state.values.cols(), 9);
  EXPECT_EQ(rows->rate.cols(), 9);
}

TEST(Rows, BeginWhenEverythingHasBeenTold) {
  RecordingLog log = lead_for(3000);
  log.objects["Cup"].add(ms(400), make_pose({0, 0, 1}));
  log.objects["Late"].add(ms(1001), make_pose({0, 0, 2}));
  const auto rows = make_rows(log, episode_of(0, 3000), {.rate = 10});
  ASSERT_TRUE(rows);
  EXPECT_NEAR(rows->action.values(0, 0), 0.4, 1e-7);
  ASSERT_NE(find(*rows, "object_Cup"), nullptr);
  EXPECT_EQ(find(*rows, "object_Cup")->values(0, 2), 1);
  EXPECT_EQ(find(*rows, "object_Late"), nullptr);
  // The one that is grasped stands under a name that is the same in every episode, too.
  ASSERT_NE(find(*rows, "object"), nullptr);
  EXPECT_EQ(find(*rows, "object")->values, find(*rows, "object_Cup")->values);
}

// A person who showed a task is not there any more when the robot does it.
TEST(Rows, AreWithoutWhatFellSilentBefore) {
  RecordingLog log = lead_for(5000);
  for (const int t : {0, 1000}) log.objects["Gone"].add(ms(t), Pose::Identity());
  for (const int t : {0, 1500}) log.objects["Still"].add(ms(t), Pose::Identity());
  for (const int t : {0, 2700}) log.objects["Back"].add(ms(t), Pose::Identity());
  const auto rows = make_rows(log, episode_of(2100, 5000), {.rate = 10});
  ASSERT_TRUE(rows);
  EXPECT_EQ(find(*rows, "object_Gone"), nullptr);
  EXPECT_NE(find(*rows, "object_Still"), nullptr);
  EXPECT_NE(find(*rows, "object_Back"), nullptr);
  EXPECT_NEAR(rows->action.values(0, 0), 2.7, 1e-7);
}

TEST(Rows, ShowTheNewestPicture) {
  RecordingLog log = lead_for(1000);
  for (int t = 0; t <= 1000; t += 100) log.cameras["front"].times.push_back(ms(t));
  const auto rows = make_rows(log, episode_of(0, 330), {.rate = 30});
  ASSERT_TRUE(rows);
  EXPECT_THAT(rows->pictures.at("front"), ElementsAre(0, 0, 0, 1, 1, 1, 2, 2, 2, 3));
}

TEST(Rows, SayWhatTheHandFeels) {
  RecordingLog log = lead_for(1000);
  log.touch_links = {"thumb", "index"};
  for (int t = 0; t <= 1000; t += 10) {
    const double s = t * 1e-3;
    log.touch_force.add(ms(t), Eigen::VectorXd{{s, 0, -1, 0, 2 * s, 0}});
    log.touch_pressure.add(ms(t), Eigen::Vector2d(s, 1 - s));
    log.touch_slip.add(ms(t), Eigen::Vector2d(0, 0.01));
  }
  const auto rows = make_rows(log, episode_of(0, 1000), {.rate = 30});
  ASSERT_TRUE(rows);
  const Feature* force = find(*rows, "touch_force");
  ASSERT_NE(force, nullptr);
  EXPECT_THAT(force->columns,
              ElementsAre("thumb.x", "thumb.y", "thumb.z", "index.x", "index.y", "index.z"));
  EXPECT_NEAR(force->values(15, 0), 0.5, 1e-7);
  EXPECT_NEAR(force->values(15, 4), 1, 1e-7);
  ASSERT_NE(find(*rows, "touch_pressure"), nullptr);
  EXPECT_NEAR(find(*rows, "touch_pressure")->values(15, 1), 0.5, 1e-7);
  ASSERT_NE(find(*rows, "touch_slip"), nullptr);
  EXPECT_THAT(find(*rows, "touch_slip")->columns, ElementsAre("thumb", "index"));
  EXPECT_EQ(find(*make_rows(lead_for(500), episode_of(0, 500), {.rate = 30}), "touch_force"),
            nullptr);
}

TEST(Rows, SignsOfQuaternionsDoNotJump) {
  RecordingLog log = lead_for(4000);
  log.X_WB = {};
  for (int t = 0; t <= 4000; t += 20)
    log.X_WB.add(
        ms(t), make_pose({0, 0, 0},
                         Eigen::AngleAxisd(t * 2e-3, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  const auto rows = make_rows(log, episode_of(0, 4000), {.rate = 50});
  ASSERT_TRUE(rows);
  // cos and sin of half the angle all the way, past half a turn, where Eigen's own sign jumps.
  for (Eigen::Index row = 0; row < rows->count; ++row) {
    const double half = static_cast<double>(row) / 50;
    EXPECT_NEAR(rows->state.values(row, 5), std::cos(half), 1e-6) << row;
    EXPECT_NEAR(rows->state.values(row, 8), std::sin(half), 1e-6) << row;
  }
}

TEST(Rows, TurnsAsColumns) {
  RecordingLog log = lead_for(500);
  log.X_WB = {};
  log.X_WB.add(
      ms(0),
      make_pose({0, 0, 0}, Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  const auto rows = make_rows(log, episode_of(0, 500), {.rate = 10, .turns = Turns::columns});
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->state.values.cols(), 11);
  const Eigen::VectorXd turn = rows->state.values.row(3).tail(6);
  Eigen::VectorXd expected(6);
  expected << std::cos(0.5), std::sin(0.5), 0, -std::sin(0.5), std::cos(0.5), 0;
  EXPECT_TRUE(turn.isApprox(expected, 1e-12)) << turn.transpose();
}

TEST(Rows, RatesOfWhatNobodyMeasuresAreDifferences) {
  const auto rows = make_rows(lead_for(1000), episode_of(0, 1000), {.rate = 20});
  ASSERT_TRUE(rows);
  for (Eigen::Index row = 0; row < rows->count; ++row) {
    EXPECT_NEAR(rows->rate(row, 0), 1, 1e-6);  // dof0: three joints do not say whose it is
    EXPECT_NEAR(rows->rate(row, 2), 1, 1e-6);  // base.x
    EXPECT_NEAR(rows->rate(row, 5), 0, 1e-6);
  }
  EXPECT_EQ(rows->effort.cols(), 0);
}

TEST(Rows, KnowAHandByItsModel) {
  const model::HandModel& hand = test::hand("barrett");
  RecordingLog log;
  const Eigen::VectorXd dof =
      0.5 * hand.postures().at("open") +
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(hand.dofs().size()), 0.3);
  const Eigen::VectorXd joint = hand.joint_angles(hand.clamp(dof));
  const Pose X_WB =
      make_pose({0.1, 0.2, 0.3}, Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()).toRotationMatrix());
  Eigen::VectorXd torque = Eigen::VectorXd::LinSpaced(joint.size(), 1, 2);
  for (int t = 0; t <= 500; t += 50) {
    log.command_dof.add(ms(t), hand.clamp(dof));
    log.command_X_WB.add(ms(t), X_WB);
    log.dof.add(ms(t), hand.clamp(dof));
    log.joint.add(ms(t), joint);
    log.velocity.add(ms(t), 2 * torque);
    log.torque.add(ms(t), torque);
    log.X_WB.add(ms(t), X_WB);
  }
  const auto rows = make_rows(log, episode_of(0, 500), {.rate = 10, .hand = &hand});
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->state.columns.front(), hand.dofs().front().name);
  const Feature* tips = find(*rows, "fingertips");
  ASSERT_NE(tips, nullptr);
  const auto expected = hand.fingertip_positions(hand.clamp(dof));
  ASSERT_EQ(tips->values.cols(), static_cast<Eigen::Index>(3 * expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_TRUE(tips->values.row(2)
                    .segment(static_cast<Eigen::Index>(3 * i), 3)
                    .transpose()
                    .isApprox(X_WB * expected[i], 1e-9));
  for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(rows->effort(1, column), torque[hand.dofs()[i].joint], 1e-12);
    EXPECT_NEAR(rows->rate(1, column), 2 * torque[hand.dofs()[i].joint], 1e-12);
  }
  EXPECT_EQ(rows->effort(1, rows->effort.cols() - 1), 0);  // the base has no drives
}

TEST(Rows, RefuseWhatIsNoEpisode) {
  RecordingLog log = lead_for(1000);
  EXPECT_FALSE(make_rows(log, episode_of(900, 910), {.rate = 30}));
  EXPECT_FALSE(make_rows(log, episode_of(900, 800), {.rate = 30}));
  log.command_dof.add(ms(2'000'000'000), Eigen::Vector2d(0, 0));
  EXPECT_FALSE(make_rows(log, episode_of(0, 2'000'000'000), {.rate = 30}));
  log.dof = {};
  const auto without = make_rows(log, episode_of(0, 1000), {.rate = 30});
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().what, ::testing::HasSubstr("robot/state"));
}

}  // namespace
}  // namespace prehend::recorder::dataset
