// The documents that others read: their keys are a contract.
#include "services/cli/service/outcome.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace prehend::cli {
namespace {

using nlohmann::json;

Outcome held() {
  Outcome outcome;
  outcome.object = {{"Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.004}};
  outcome.mode = v1::MODE_INTELLIGENT;
  outcome.weight = 0.9;
  outcome.hand = "barrett";
  outcome.grasp_type = v1::GRASP_POWER_WRAP;
  outcome.judged = true;
  outcome.grasp = {6, 0.05, 0.002, true, true, ""};
  outcome.latency = {1.25, 3.5};
  outcome.device = "nest_of_birds";
  outcome.frames = 120;
  outcome.rejected = 2;
  return outcome;
}

TEST(Outcome, DocumentOfAHeldObject) {
  const json document = json::parse(to_json(held()));
  EXPECT_EQ(document["object"]["name"], "Talc");
  EXPECT_EQ(document["object"]["shape"], "cylinder");
  EXPECT_EQ(document["object"]["size_m"], json({0.024, 0.024, 0.105}));
  EXPECT_EQ(document["object"]["position_error_m"], 0.004);
  EXPECT_EQ(document["mapping"]["mode"], "intelligent");
  EXPECT_EQ(document["mapping"]["weight"], 0.9);
  EXPECT_EQ(document["mapping"]["hand"], "barrett");
  EXPECT_EQ(document["mapping"]["grasp_type"], "power_wrap");
  EXPECT_EQ(document["grasp"]["contacts"], 6);
  EXPECT_EQ(document["grasp"]["epsilon"], 0.05);
  EXPECT_EQ(document["grasp"]["volume"], 0.002);
  EXPECT_EQ(document["grasp"]["force_closure"], true);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_EQ(document["latency_ms"]["p50"], 1.25);
  EXPECT_EQ(document["latency_ms"]["p99"], 3.5);
  EXPECT_EQ(document["glove"]["device"], "nest_of_birds");
  EXPECT_EQ(document["glove"]["frames"], 120);
  EXPECT_EQ(document["glove"]["rejected"], 2);
}

TEST(Outcome, AnArmIsToldWhereThereIsOne) {
  Outcome outcome = held();
  EXPECT_FALSE(json::parse(to_json(outcome)).contains("arm"));
  outcome.arm = {"puma560", 0.75, 0.125};
  const json arm = json::parse(to_json(outcome))["arm"];
  EXPECT_EQ(arm, json({{"name", "puma560"}, {"worst_joint_speed", 0.75}, {"out_of_reach", 0.125}}));
  EXPECT_NE(to_table(outcome).find("puma560"), std::string::npos);
}

TEST(Outcome, UnknownIsNull) {
  Outcome outcome;
  const json nothing = json::parse(to_json(outcome));
  EXPECT_TRUE(nothing["object"].is_null());
  EXPECT_TRUE(nothing["latency_ms"]["p50"].is_null());
  EXPECT_EQ(nothing["mapping"]["mode"], "hold");
  EXPECT_EQ(nothing["grasp"]["epsilon"], -1);
  EXPECT_EQ(nothing["grasp"]["held"], false);
  outcome.object = {{"Talc", {}, std::nullopt}};
  EXPECT_TRUE(json::parse(to_json(outcome))["object"]["position_error_m"].is_null());
}

TEST(Outcome, DocumentIsJsonWhateverTheNames) {
  Outcome outcome = held();
  outcome.object->name = "quote\" and \xff\xfe";
  EXPECT_TRUE(json::accept(to_json(outcome)));
  EXPECT_EQ(to_json(outcome).find('\n'), std::string::npos);
}

TEST(Outcome, TableSaysWhetherAndWhyNot) {
  EXPECT_NE(to_table(held()).find("result      held\n"), std::string::npos);
  EXPECT_NE(to_table(held()).find("4.0 mm"), std::string::npos);
  Outcome dropped = held();
  dropped.grasp.held = false;
  dropped.grasp.reason = "slipped 31 mm";
  EXPECT_NE(to_table(dropped).find("dropped: slipped 31 mm"), std::string::npos);
  dropped.judged = false;
  EXPECT_NE(to_table(dropped).find("no grasp: slipped 31 mm"), std::string::npos);
}

}  // namespace
}  // namespace prehend::cli
