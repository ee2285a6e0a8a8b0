// A recorded grasp goes through the view: what would be drawn is what was said.
#include "services/console/core/lab_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "common/dds/topics.hpp"
#include "common/recording/layout/layout.hpp"
#include "common/recording/layout/older_types.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/types/idl.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::console {
namespace {

using nlohmann::json;

const model::HandModel& barrett() {
  static const model::HandModel hand =
      model::HandModel::load(test::in_sources("common/models/hands/barrett")).value();
  return hand;
}

LabView view() {
  return LabView({.services = {"glove", "simulation"}, .hand = [](const std::string& name) {
                    return name == "barrett" ? &barrett() : nullptr;
                  }});
}

/// Calls with every message of the sample recording.
void play(const std::function<void(const std::string& topic, const Value&)>& each) {
  const auto types = recording::types::load_idl(test::in_sources("idl")).value();
  auto reader =
      recording::mcap::Reader::open(test::in_sources("deploy/samples/intelligent-grasp.mcap"))
          .value();
  auto cursor = reader.messages();
  while (auto next = cursor.next().value()) {
    const auto stream = recording::to_stream(
        *next->channel, reader.contents().schemas.at(next->channel->schema_id).name);
    if (!stream || stream->kind != dds::RawSample::Kind::data) continue;
    const std::string current(recording::current_type(stream->topic.type));
    const auto* type = types.find(current);
    ASSERT_TRUE(type) << current;
    std::vector<std::uint8_t> bytes(next->message.data.begin(), next->message.data.end());
    if (current != stream->topic.type) recording::make_current(bytes);
    const auto value = recording::types::decode(*type, bytes);
    ASSERT_TRUE(value) << value.error().message();
    each(stream->topic.name, *value);
  }
}

/// A message as clients get it, who are told a list as a whole.
json message_of(const Document& document) {
  const auto [opening, closing] = around(feeds[static_cast<std::size_t>(document.feed)]);
  return json::parse(opening + document.text + closing);
}

/// Names of who is missing; each is told with a reason.
std::vector<std::string> missing(const json& status) {
  std::vector<std::string> names;
  for (const json& one : status["missing"]) {
    EXPECT_FALSE(one["reason"].get<std::string>().empty());
    names.push_back(one["name"]);
  }
  return names;
}
using Names = std::vector<std::string>;

Pose pose_of(const json& t) {
  const auto number = [&](const char* part, const char* name) {
    return t[part][name].get<double>();
  };
  const auto p = [&](const char* name) { return number("translation", name); };
  const auto q = [&](const char* name) { return number("rotation", name); };
  return make_pose(Eigen::Vector3d(p("x"), p("y"), p("z")),
                   Eigen::Quaterniond(q("w"), q("x"), q("y"), q("z")));
}

// Forward kinematics by hand: each joint's frame after its parent's, then its own motion.
TEST(LabView, EachLinkIsWhereTheJointAnglesPutIt) {
  LabView shown = view();
  int compared = 0;
  play([&](const std::string& topic, const Value& value) {
    if (topic != "robot/state") return;
    const View message(value);
    const Pose X_WB = message["X_WB"].pose().value();
    const auto joint = message["joint"].numbers();
    std::map<std::string, Pose> expected{{barrett().links()[0].name, X_WB}};
    for (std::size_t i = 0; i < joint.size(); ++i) {
      const model::HandJoint& j = barrett().joints()[i];
      const auto at = [&](int link) {
        return barrett().links()[static_cast<std::size_t>(link)].name;
      };
      expected[at(j.child)] =
          expected.at(at(j.parent)) * j.X_PJ * Pose(Eigen::AngleAxisd(joint[i], j.axis_J));
    }
    for (const Document& document : shown.hear(topic, value, 0)) {
      if (document.feed != Feed::tf) continue;
      EXPECT_EQ(document.stamp_ns, message["stamp_ns"].integer());
      const json said = message_of(document)["transforms"];
      ASSERT_EQ(said.size(), expected.size());
      for (const json& t : said) {
        EXPECT_EQ(t["parent_frame_id"], "table");
        // Nine digits are told.
        EXPECT_TRUE(pose_of(t).isApprox(expected.at(t["child_frame_id"].get<std::string>()), 1e-8));
        ++compared;
      }
    }
  });
  EXPECT_GT(compared, 100);
}

TEST(LabView, AGraspIsDrawnWholeAndEveryDocumentIsWhatItsSchemaSays) {
  LabView shown = view();
  std::map<Feed, int> counts;
  std::map<std::string, json> entities;
  json status;
  std::set<std::string> groups;
  const auto take = [&](const Documents& documents) {
    for (const Document& document : documents) {
      ++counts[document.feed];
      const json said = message_of(document);
      const FeedInfo& feed = feeds[static_cast<std::size_t>(document.feed)];
      EXPECT_EQ(feed.feed, document.feed);
      if (feed.schema_name.starts_with("foxglove.")) {
        const json schema = json::parse(json_schema(feed.feed));
        for (const auto& [name, type] : schema["properties"].items())
          EXPECT_TRUE(said.contains(name)) << feed.topic << " lacks " << name;
      }
      if (document.feed == Feed::status) status = said;
      if (document.feed == Feed::signals) {
        EXPECT_EQ(said["names"].size(), said["values"].size());
        groups.insert(said["group"]);
      }
      if (document.feed != Feed::scene) continue;
      for (const json& gone : said["deletions"]) entities.erase(gone["id"]);
      for (const json& entity : said["entities"]) entities[entity["id"]] = entity;
    }
  };
  take(shown.begin(0));
  EXPECT_EQ(missing(status), (Names{"glove", "simulation"}));
  play([&](const std::string& topic, const Value& value) { take(shown.hear(topic, value, 0)); });
  for (const Feed feed : {Feed::tf, Feed::scene, Feed::image, Feed::annotations, Feed::report,
                          Feed::log, Feed::signals})
    EXPECT_GT(counts[feed], 0) << feeds[static_cast<std::size_t>(feed)].topic;
  EXPECT_EQ(groups, (std::set<std::string>{"fingertips", "joints", "touch", "weight"}));
  EXPECT_TRUE(entities.contains("table"));
  EXPECT_TRUE(entities.contains("hand/" + barrett().links()[0].name));
  EXPECT_TRUE(entities.contains("glove/glove"));
  EXPECT_EQ(entities["hand/grasp frame"]["arrows"].size(), 3U);
  ASSERT_TRUE(entities.contains("contacts/hand"));
  EXPECT_GE(entities["contacts/hand"]["arrows"].size(), 2U);
  EXPECT_EQ(entities["contacts/hand"]["triangles"].size(),
            entities["contacts/hand"]["arrows"].size());
  EXPECT_EQ(entities["contacts/hand"]["frame_id"].get<std::string>().substr(0, 7), "object/");
  EXPECT_TRUE(entities.contains(entities["contacts/hand"]["frame_id"])) << "the object is drawn";
  // What it resists, since the report tells of force closure.
  ASSERT_EQ(entities["forces/hand"]["triangles"].size(), 1U);
  EXPECT_EQ(entities["forces/hand"]["triangles"][0]["points"].size() % 3, 0U);
  EXPECT_EQ(entities["forces/hand"]["frame_id"], entities["contacts/hand"]["frame_id"]);
}

Value structure(std::vector<std::pair<std::string_view, Value>> fields) {
  Value::Fields made;
  for (auto& [name, value] : fields) made.push_back({name, std::move(value)});
  return Value{std::move(made)};
}

TEST(LabView, WhatIsTaughtIsToldByTheHandThatLearns) {
  LabView shown = view();
  const Value message =
      structure({{"hand", Value{std::string("barrett")}},
                 {"stamp_ns", Value{std::int64_t{5}}},
                 {"phase", Value{recording::types::Enumerator{1, "TRAINING_SHOWING"}}},
                 {"name", Value{std::string("me")}},
                 {"step", Value{std::string("open")}},
                 {"shown", Value{std::uint64_t{2}}},
                 {"asked", Value{std::uint64_t{7}}},
                 {"share", Value{0.25}},
                 {"message", Value{std::string("keep still")}}});
  const Documents told = shown.hear("mapping/training", message, 9);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].feed, Feed::training);
  EXPECT_EQ(told[0].key, "barrett");
  EXPECT_EQ(told[0].stamp_ns, 5);
  const json said = message_of(told[0]), schema = json::parse(json_schema(Feed::training));
  EXPECT_EQ(said["phase"], "TRAINING_SHOWING");
  for (const auto& [name, type] : schema["properties"].items())
    EXPECT_TRUE(said.contains(name)) << name;
}

Value vector_of(double x, double y, double z) {
  return structure({{"x", Value{x}}, {"y", Value{y}}, {"z", Value{z}}});
}

/// An object that was seen, with these standard deviations of its place, m, and two of them
/// correlated.
Value seen(double sigma_x, double sigma_y, double sigma_z, double correlation) {
  Value::List covariance(16, Value{0.0});
  const auto set = [&](std::size_t at, double value) { covariance[at] = Value{value}; };
  set(0, sigma_x * sigma_x);
  set(5, sigma_y * sigma_y);
  set(10, sigma_z * sigma_z);
  set(1, correlation * sigma_x * sigma_y);
  set(4, correlation * sigma_x * sigma_y);
  return structure({{"track", Value{std::uint64_t{3}}},
                    {"shape", Value{recording::types::Enumerator{1, "SHAPE_BOX"}}},
                    {"size", vector_of(0.1, 0.1, 0.1)},
                    {"X_WO", structure({{"position", vector_of(0.3, -0.2, 0.05)},
                                        {"orientation", structure({{"w", Value{1.0}},
                                                                   {"x", Value{0.0}},
                                                                   {"y", Value{0.0}},
                                                                   {"z", Value{0.0}}})}})},
                    {"covariance", Value{std::move(covariance)}}});
}

/// The ellipsoids that are drawn of it.
json doubts(const Value& message) {
  for (const Document& document : view().hear("object/detection", message, 0))
    if (document.feed == Feed::scene) return json::parse(document.text)["entities"][0]["spheres"];
  return {};
}

// Two standard deviations to each side, along the axes of the covariance.
TEST(LabView, WhereAnObjectMayBeIsDrawn) {
  json drawn = doubts(seen(0.01, 0.02, 0.005, 0));
  ASSERT_EQ(drawn.size(), 1U);
  EXPECT_EQ(drawn[0]["pose"]["position"], (json{{"x", 0.3}, {"y", -0.2}, {"z", 0.05}}));
  std::vector<double> size{drawn[0]["size"]["x"], drawn[0]["size"]["y"], drawn[0]["size"]["z"]};
  std::ranges::sort(size);
  EXPECT_NEAR(size[0], 4 * 0.005, 1e-9);
  EXPECT_NEAR(size[1], 4 * 0.01, 1e-9);
  EXPECT_NEAR(size[2], 4 * 0.02, 1e-9);
  // Nearly all along the diagonal of x and y: that axis is longer, the one across shorter.
  drawn = doubts(seen(0.01, 0.01, 0.01, 0.96));
  size = {drawn[0]["size"]["x"], drawn[0]["size"]["y"], drawn[0]["size"]["z"]};
  EXPECT_NEAR(*std::ranges::max_element(size), 4 * 0.014, 1e-9);
  EXPECT_NEAR(*std::ranges::min_element(size), 4 * 0.002, 1e-9);
  EXPECT_TRUE(doubts(seen(0, 0, 0, 0)).empty()) << "it is certain";
  EXPECT_TRUE(doubts(seen(HUGE_VAL, 0, 0, 0)).empty());
  EXPECT_TRUE(doubts(seen(50, 0.1, 0.1, 0)).empty()) << "nothing is known";
}

TEST(LabView, WhatIsGoneIsNotShownAnyMore) {
  LabView shown = view();
  const Value status =
      structure({{"service", Value{std::string("glove@lab/1")}},
                 {"name", Value{std::string("glove")}},
                 {"state", Value{recording::types::Enumerator{2, "STATE_DEGRADED"}}},
                 {"message", Value{std::string("no tracker")}}});
  auto documents = shown.hear("service/status", status, 7);
  ASSERT_EQ(documents.size(), 3U);
  EXPECT_EQ(documents[0].feed, Feed::log);
  EXPECT_EQ(json::parse(documents[1].text)["services"][0]["state"], "degraded");
  EXPECT_EQ(missing(json::parse(documents[1].text)), (Names{"simulation"}));
  EXPECT_EQ(shown.hear("service/status", status, 8).size(), 2U) << "nothing new to log";
  documents = shown.lose("service/status", status, 9);
  EXPECT_EQ(documents[0].feed, Feed::log);
  EXPECT_EQ(missing(json::parse(documents[1].text)), (Names{"glove", "simulation"}));
}

constexpr std::int64_t second = 1'000'000'000;

Value status_of(const std::string& name, int process) {
  return structure({{"service", Value{name + "@lab/" + std::to_string(process)}},
                    {"name", Value{name}},
                    {"state", Value{recording::types::Enumerator{1, "STATE_RUNNING"}}},
                    {"stamp_ns", Value{std::int64_t{-99 * second}}}});  // of a clock that is wrong
}

/// The last status among documents.
json told(const Documents& documents) {
  json last;
  for (const Document& document : documents)
    if (document.feed == Feed::status) last = json::parse(document.text);
  return last;
}

// Who is killed says no farewell, and DDS tells its readers nothing either.
TEST(LabView, WhoIsSilentIsMissingAndComesBackAlone) {
  LabView shown = view();
  shown.hear("service/status", status_of("glove", 1), 10 * second);
  shown.hear("service/status", status_of("simulation", 2), 10 * second);
  EXPECT_TRUE(shown.wait(12 * second).empty()) << "a status may come late";
  json status = told(shown.hear("service/status", status_of("simulation", 2), 12 * second));
  EXPECT_EQ(missing(status), Names{});
  status = told(shown.wait(13 * second));
  EXPECT_EQ(missing(status), (Names{"glove"}));
  EXPECT_NE(status["missing"][0]["reason"].get<std::string>().find("glove@lab/1"),
            std::string::npos);
  EXPECT_EQ(status["services"].size(), 1U);
  EXPECT_TRUE(shown.wait(14 * second).empty()) << "told once";
  // The same process after a hole in the network.
  const Documents again = shown.hear("service/status", status_of("glove", 1), 14 * second);
  EXPECT_EQ(missing(told(again)), Names{});
  EXPECT_EQ(again[0].feed, Feed::log) << "its return is told, too";
}

TEST(LabView, AnotherProcessOfThatNameTakesTheKilledOnesPlace) {
  LabView shown = view();
  shown.hear("service/status", status_of("simulation", 2), 0);
  shown.hear("service/status", status_of("glove", 1), 0);
  shown.hear("service/status", status_of("glove", 3), 0);
  shown.hear("service/status", status_of("simulation", 2), 5 * second);
  shown.hear("service/status", status_of("glove", 3), 5 * second);
  EXPECT_EQ(missing(told(shown.wait(5 * second))), (Names{"glove"})) << "one of two";
  json status = told(shown.hear("service/status", status_of("glove", 3), 6 * second));
  EXPECT_EQ(missing(status), (Names{"glove"})) << "who was there before replaces nobody";
  status = told(shown.hear("service/status", status_of("glove", 4), 6 * second));
  EXPECT_EQ(missing(status), Names{});
  EXPECT_EQ(status["services"].size(), 3U);
}

// Names come from other programs. Whatever they are, a document stays one.
TEST(LabView, ANameOfAFrameIsOneString) {
  for (const std::string name :
       {"cup", "a\"b", "a\\b", "tab\t", "\x7f", "caf\xc3\xa9", "\xff", "\"},{\"x\":1", ""}) {
    std::string list;
    add_transform(list, 1'500'000'000, "table", name, make_pose(Eigen::Vector3d(1, -2.5, 1e-7)));
    add_transform(list, -1, name, "b", make_pose(Eigen::Vector3d(HUGE_VAL, 0, 0)));
    const json said = json::parse("[" + list + "]");
    ASSERT_EQ(said.size(), 2U) << name;
    EXPECT_EQ(said[0].size(), 5U) << name;
    const bool is_text = name != "\xff";  // what is none is replaced
    EXPECT_EQ(said[0]["child_frame_id"] == name, is_text);
    EXPECT_EQ(said[0]["timestamp"], (json{{"sec", 1}, {"nsec", 500'000'000}}));
    EXPECT_EQ(said[0]["translation"], (json{{"x", 1.0}, {"y", -2.5}, {"z", 1e-7}}));
    EXPECT_EQ(said[1]["timestamp"]["sec"], 0);
    EXPECT_TRUE(said[1]["translation"]["x"].is_null());
  }
}

TEST(LabView, WhatAHandFeelsIsDrawnWhereItPressesAndPlottedForEachFinger) {
  LabView shown = view();
  const auto vector = [](double x, double y, double z) {
    return structure({{"x", Value{x}}, {"y", Value{y}}, {"z", Value{z}}});
  };
  const auto pad = [&](bool touching, double pressure) {
    return structure({{"touching", Value{touching}},
                      {"pressure", Value{pressure}},
                      {"p_BC", vector(0.01, 0.02, 0.03)},
                      {"force_B", vector(0, 0, pressure)}});
  };
  const auto drawn = [&](std::vector<Value> pads) {
    const auto made = shown.hear("robot/touch",
                                 structure({{"hand", Value{std::string("hand")}},
                                            {"model", Value{std::string("barrett")}},
                                            {"pads", Value{Value::List(std::move(pads))}}}),
                                 0);
    EXPECT_EQ(made.size(), 1U);
    return message_of(made.at(0))["entities"].at(0);
  };
  const json one = drawn({pad(true, 4), pad(false, 4), pad(true, std::nan(""))});
  EXPECT_EQ(one["id"], "touch/hand");
  ASSERT_EQ(one["spheres"].size(), 1U);
  EXPECT_EQ(one["spheres"][0]["pose"]["position"], (json{{"x", 0.01}, {"y", 0.02}, {"z", 0.03}}));
  ASSERT_EQ(one["arrows"].size(), 1U);
  EXPECT_TRUE(drawn({})["spheres"].empty()) << "what is let go is drawn no more";

  std::vector<Value> fingers;
  for (int f = 0; f < 5; ++f) fingers.push_back(structure({{"force", Value{1.5 * f}}}));
  const auto plotted = shown.hear("glove/feedback",
                                  structure({{"glove", Value{std::string("glove")}},
                                             {"fingers", Value{Value::List(std::move(fingers))}}}),
                                  0);
  ASSERT_EQ(plotted.size(), 1U);
  const json said = message_of(plotted[0]);
  EXPECT_EQ(said["names"], (json{"thumb", "index", "middle", "ring", "little"}));
  EXPECT_EQ(said["values"], (json{0.0, 1.5, 3.0, 4.5, 6.0}));
}

TEST(LabView, DamagedMessagesDrawNothing) {
  LabView shown = view();
  for (const dds::TopicInfo& topic : dds::topic_table) {
    shown.hear(topic.name, Value{Value::Fields{}}, 0);
    shown.hear(topic.name, Value{3.0}, 0);
    shown.lose(topic.name, Value{Value::List{}}, 0);
  }
  const auto pose = [](double w) {
    return structure(
        {{"position", structure({{"x", Value{0.0}}, {"y", Value{0.0}}, {"z", Value{0.0}}})},
         {"orientation",
          structure({{"w", Value{w}}, {"x", Value{0.0}}, {"y", Value{0.0}}, {"z", Value{0.0}}})}});
  };
  const auto state = [&](double w, std::size_t joints) {
    return structure({{"hand", Value{std::string("hand")}},
                      {"model", Value{std::string("barrett")}},
                      {"joint", Value{Value::List(joints, Value{0.1})}},
                      {"X_WB", pose(w)}});
  };
  EXPECT_FALSE(shown.hear("robot/state", state(1, barrett().joints().size()), 0).empty());
  EXPECT_TRUE(shown.hear("robot/state", state(0, barrett().joints().size()), 0).empty());
  EXPECT_TRUE(shown.hear("robot/state", state(1, 3), 0).empty());
}

}  // namespace
}  // namespace prehend::console
