// Plans come back from a folder as they were, for the same hand and object only; what is damaged is
// not there.
#include "services/planner/files/plan_store.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "common/base/file_text.hpp"
#include "common/stage/temporary_folder.hpp"
#include "tests/support/hands.hpp"

namespace prehend::planner {
namespace {

namespace fs = std::filesystem;

Plan plan_for(const model::HandModel& hand) {
  Plan plan;
  plan.object = {"thing", {model::ShapeKind::box, {0.03, 0.04, 0.1}}, 0.2, "wood", {}, {}};
  plan.complete = true;
  grasping::SureGrasp grasp;
  grasp.X_OG = make_pose({0.01, 0.02, 0.03});
  grasp.grasp.X_OG = make_pose({0.011, 0.02, 0.03});
  grasp.grasp.open = hand.postures().at("open");
  grasp.grasp.dof = grasp.grasp.open;
  grasp.grasp.closing = Eigen::VectorXd::Constant(grasp.grasp.dof.size(), -1);
  grasp.grasp.epsilon = 0.125;
  grasp.room = 0.75;
  grasp.tried = 4;
  grasp.follow_through = 0.25;
  plan.grasps = {grasp, grasp};
  return plan;
}

class PlanStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(hand_folder);
    fs::copy(model::hand_directory("barrett"), hand_folder, fs::copy_options::recursive);
  }
  PlanStore store() const { return plan_store(folder.path() / "plans", hand_folder, hand); }
  fs::path only_file() const { return fs::directory_iterator(folder.path() / "plans")->path(); }

  stage::TemporaryFolder folder = stage::TemporaryFolder::create(false).value();
  fs::path hand_folder = folder.path() / "barrett";
  const model::HandModel& hand = test::hand("barrett");
  Plan plan = plan_for(hand);
};

TEST_F(PlanStoreTest, RecallsWhatItKeptBitForBit) {
  EXPECT_FALSE(store().recall(plan.object));
  store().keep(plan);
  const auto again = store().recall(plan.object);
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->complete);
  ASSERT_EQ(again->grasps.size(), 2u);
  const grasping::SureGrasp &was = plan.grasps[1], &is = again->grasps[1];
  EXPECT_EQ(is.X_OG.matrix(), was.X_OG.matrix());
  EXPECT_EQ(is.grasp.X_OG.matrix(), was.grasp.X_OG.matrix());
  EXPECT_EQ(is.grasp.open, was.grasp.open);
  EXPECT_EQ(is.grasp.dof, was.grasp.dof);
  EXPECT_EQ(is.grasp.closing, was.grasp.closing);
  EXPECT_EQ(is.grasp.epsilon, was.grasp.epsilon);
  EXPECT_EQ(is.room, was.room);
  EXPECT_EQ(is.tried, was.tried);
  EXPECT_EQ(is.follow_through, was.follow_through);
}

TEST_F(PlanStoreTest, WhyThereIsNoneIsKeptToo) {
  plan.grasps.clear();
  plan.reason = "does not hold";
  store().keep(plan);
  EXPECT_EQ(store().recall(plan.object)->reason, "does not hold");
}

TEST_F(PlanStoreTest, AnotherObjectIsAnother) {
  store().keep(plan);
  for (const auto change :
       {+[](grasping::Body& body) { body.shape.size.x() += 0.001; },
        +[](grasping::Body& body) { body.mass *= 1.5; },
        +[](grasping::Body& body) { body.material = "metal"; },
        +[](grasping::Body& body) { body.shape.kind = model::ShapeKind::sphere; }}) {
    grasping::Body other = plan.object;
    change(other);
    EXPECT_FALSE(store().recall(other));
  }
}

TEST_F(PlanStoreTest, AHandThatWasCorrectedIsAnother) {
  store().keep(plan);
  std::ofstream(hand_folder / "hand.toml", std::ios::app) << "# corrected\n";
  EXPECT_FALSE(store().recall(plan.object));
}

TEST_F(PlanStoreTest, WhatIsDamagedIsNotThere) {
  store().keep(plan);
  const std::string whole = read_file(only_file()).value();
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    ASSERT_TRUE(write_file(only_file(), damaged));
    EXPECT_FALSE(store().recall(plan.object)) << "byte " << at;
  }
  ASSERT_TRUE(write_file(only_file(), whole.substr(0, whole.size() / 2)));
  EXPECT_FALSE(store().recall(plan.object));
}

TEST_F(PlanStoreTest, WithoutAFolderNothingIsKept) {
  const PlanStore nowhere = plan_store({}, hand_folder, hand);
  nowhere.keep(plan);
  EXPECT_FALSE(nowhere.recall(plan.object));
}

}  // namespace
}  // namespace prehend::planner
