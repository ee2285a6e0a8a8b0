// The main job: the demonstration ends with the object held. Real time: nothing else may run, since
// a hand whose glove is late by a tenth of a second closes elsewhere, and may rightly drop what it
// holds.
#include "tests/integration/demo_rig.hpp"

namespace prehend::integration {
namespace {

using nlohmann::json;

class DemoOfSeed : public Demo, public testing::WithParamInterface<const char*> {};

TEST_P(DemoOfSeed, HoldsTheRightObjectIntelligently) {
  const Answer answer = demo({"--seed", GetParam()});
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_GT(document["grasp"]["epsilon"].get<double>(), 0);
  EXPECT_GE(document["grasp"]["contacts"].get<int>(), 2);
  EXPECT_EQ(document["mapping"]["mode"], "intelligent");
  EXPECT_EQ(document["mapping"]["hand"], "barrett");
  EXPECT_EQ(document["object"]["name"], document["target"]);
  EXPECT_LT(document["object"]["position_error_m"].get<double>(), 0.02);
  EXPECT_EQ(document["glove"]["device"], "nest_of_birds");
  EXPECT_GT(document["glove"]["frames"].get<int>(), 30);
  EXPECT_GT(document["latency_ms"]["p50"].get<double>(), 0);
  EXPECT_GE(document["latency_ms"]["p99"].get<double>(),
            document["latency_ms"]["p50"].get<double>());
}

INSTANTIATE_TEST_SUITE_P(BoxAndCylinder, DemoOfSeed, testing::Values("1", "2"));

// Other hands than the first one: DLR's closed on nothing for a while, since its fingers met the
// table, and of a jaw with one drive no closure was ever reported.
class DemoOfHand : public Demo, public testing::WithParamInterface<const char*> {};

TEST_P(DemoOfHand, HoldsTheObject) {
  const Answer answer = demo({"--seed", "1", "--hand", GetParam()});
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_EQ(document["mapping"]["mode"], "intelligent");
  EXPECT_EQ(document["mapping"]["hand"], GetParam());
}

INSTANTIATE_TEST_SUITE_P(Others, DemoOfHand, testing::Values("dlr", "parallel_jaw"));

// Through the driver of a hand as it is sold, and what is emulated at the end of its wire.
class DemoOfRobot : public Demo, public testing::WithParamInterface<const char*> {};

TEST_P(DemoOfRobot, HoldsTheObject) {
  const Answer answer = demo({"--seed", "1", "--robot", std::string("emulated:") + GetParam()});
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_EQ(document["mapping"]["hand"], GetParam());
}

INSTANTIATE_TEST_SUITE_P(Sold, DemoOfRobot, testing::Values("robotiq_2f85", "inspire_rh56"));

// Grasps are planned for what is seen, and the hand follows one.
TEST_F(Demo, WithPlannedGraspsHoldsTheObject) {
  ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
  const Answer answer = demo({"--seed", "1", "--mode", "planned"});
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_EQ(document["mapping"]["mode"], "intelligent");
  EXPECT_FALSE(std::filesystem::is_empty(folder_ / "state/prehend/grasps/barrett"))
      << "what was searched is kept";
}

// The same grasp through devices that have nothing in common but hand/posture.
class DemoOfDevice : public Demo, public testing::WithParamInterface<const char*> {};

TEST_P(DemoOfDevice, HoldsTheObject) {
  const Answer answer = demo({"--seed", "1", "--glove", GetParam()});
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_EQ(document["glove"]["device"], GetParam());
  EXPECT_GT(document["glove"]["frames"].get<int>(), 30);
}

INSTANTIATE_TEST_SUITE_P(Emulated, DemoOfDevice, testing::Values("joint_glove", "landmarks"));

}  // namespace
}  // namespace prehend::integration
