// The table is checked by what it says, the document by its keys, which others rely on.
#include "services/cli/tools/status/status_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace prehend::cli {
namespace {

using json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const Time start = from_ns(1'700'000'000'000'000'000);

v1::ServiceStatus status(const std::string& name, const std::string& host = "here") {
  v1::ServiceStatus message;
  message.service(name + "@" + host + "/1");
  message.name(name);
  message.host(host);
  message.state(v1::STATE_RUNNING);
  return message;
}

v1::ClockBeacon beacon(const std::string& name, const std::string& of = "", double offset = 0) {
  v1::ClockBeacon message;
  message.service(name + "@here/1");
  if (of.empty()) return message;
  v1::ClockPeer peer;
  peer.service(of + "@here/1");
  peer.known(true);
  peer.offset_ns(static_cast<std::int64_t>(offset * 1e9));
  peer.uncertainty_ns(200'000);
  message.peers().push_back(peer);
  return message;
}

TEST(StatusView, Document) {
  v1::ServiceStatus glove = status("glove");
  glove.state(v1::STATE_DEGRADED);
  glove.message("no frames");
  glove.rates().resize(1);
  glove.rates()[0].name("frames");
  glove.rates()[0].per_second(30);
  glove.rates()[0].total(90);
  glove.drops().resize(1);
  glove.drops()[0].reason("stale");
  glove.drops()[0].count(4);
  glove.latency().resize(1);
  glove.latency()[0].stage("filter");
  glove.latency()[0].p50_us(12);
  StatusView view({"glove", "mapping"});
  view.hear(glove, start);
  view.hear(beacon("mapping", "glove", 3600), start);
  const json document = json::parse(view.json(start));
  EXPECT_EQ(document["missing"], json({"mapping"}));
  ASSERT_EQ(document["services"].size(), 1u);
  const json& service = document["services"][0];
  EXPECT_EQ(service["name"], "glove");
  EXPECT_EQ(service["host"], "here");
  EXPECT_EQ(service["state"], "degraded");
  EXPECT_EQ(service["message"], "no frames");
  EXPECT_EQ(service["rates"]["frames"]["per_second"], 30);
  EXPECT_EQ(service["dropped"]["stale"], 4);
  EXPECT_EQ(service["latency_us"]["filter"]["p50"], 12);
  EXPECT_EQ(service["clock"]["offset_s"], 3600);
  EXPECT_EQ(service["clock"]["uncertainty_s"], 200e-6);
  EXPECT_EQ(service["clock"]["against"], "mapping@here/1");
}

TEST(StatusView, ThePageSaysWhatGoesOn) {
  v1::ServiceStatus mapping = status("mapping", "far");
  mapping.state(v1::STATE_DEGRADED);
  mapping.message("nobody sends hand/posture; the hand stays as it is");
  mapping.drops().resize(1);
  mapping.drops()[0].reason("posture stale");
  mapping.drops()[0].count(4);
  StatusView view({"glove", "mapping"});
  view.hear(status("glove"), start);
  view.hear(mapping, start);
  mapping.drops()[0].count(11);
  view.hear(mapping, start + seconds(1));
  const std::string page = view.page(start + seconds(1));
  EXPECT_THAT(page, HasSubstr("2 services on 2 hosts"));
  EXPECT_THAT(page, Not(HasSubstr("missing")));
  EXPECT_THAT(page, HasSubstr("nobody sends hand/posture"));
  EXPECT_THAT(page, testing::ContainsRegex("posture stale +\\+7 +11\n"));
  EXPECT_THAT(StatusView({}).page(start), HasSubstr("no service is there"));
}

// A lab of two hands has two of some: it says whose each is, and one of them is not both.
TEST(StatusView, OfSeveralOfANameItSaysWhose) {
  StatusView view({});
  const auto mapping_of = [](const std::string& hand) {
    v1::ServiceStatus mapping = status("mapping");
    mapping.service("mapping@here/" + hand + "/1");
    return mapping;
  };
  view.hear(status("simulation"), start);
  view.hear(mapping_of("left"), start);
  EXPECT_EQ(view.up("mapping", start), 1u);
  EXPECT_THAT(view.page(start), Not(HasSubstr("mapping left")));
  view.hear(mapping_of("right"), start);
  EXPECT_EQ(view.up("mapping", start), 2u);
  EXPECT_EQ(view.up("simulation", start), 1u);
  EXPECT_THAT(view.page(start), HasSubstr("\nmapping left  here"));
  EXPECT_THAT(view.page(start), HasSubstr("\nmapping right here"));
  EXPECT_THAT(view.page(start), HasSubstr("\nsimulation    here"));
  const json document = json::parse(view.json(start));
  EXPECT_EQ(document["services"][0]["instance"], "left");
  EXPECT_EQ(document["services"][2]["instance"], "");
  view.lose("mapping@here/left/1", start);
  EXPECT_EQ(view.up("mapping", start), 1u);
}

// Whatever a service calls itself: the terminal shows it and does not obey it.
TEST(StatusView, NamesCommandNoTerminal) {
  v1::ServiceStatus evil = status("a\x1b[2J", "b\x1b]0;c\x07");
  evil.message("d\r\x1b[1Ae\nf");
  evil.rates().resize(1);
  evil.rates()[0].name("g\x1b[8m");
  evil.drops().resize(1);
  evil.drops()[0].reason("h\x1b[8m");
  evil.latency().resize(1);
  evil.latency()[0].stage("i\x1b[8m");
  StatusView view({});
  view.hear(evil, start);
  const std::string page = view.page(start);
  EXPECT_THAT(page, HasSubstr("a\\x1b[2J"));
  for (const char c : page)
    EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n') << static_cast<int>(c);
  EXPECT_THAT(page, HasSubstr("e\\x0af")) << "no line of its own";
  EXPECT_EQ(json::parse(view.json(start))["services"][0]["name"], "a\x1b[2J")
      << "programs get it whole";
}

TEST(StatusView, WhoFallsSilentOrSaysGoodbyeIsMissing) {
  StatusView view({"glove", "mapping"});
  view.hear(status("glove"), start);
  EXPECT_EQ(view.up("glove", start + seconds(1)), 1u);
  EXPECT_THAT(view.missing(start + seconds(1)), ElementsAre("mapping"));
  // Killed: nobody says so, but nothing is heard any more.
  EXPECT_EQ(view.up("glove", start + seconds(4)), 0u);
  EXPECT_THAT(view.missing(start + seconds(4)), ElementsAre("glove", "mapping"));
  EXPECT_THAT(view.page(start + seconds(4)), HasSubstr("silent 4 s"));
  // Heard again, then stopped as it should be.
  view.hear(status("glove"), start + seconds(5));
  view.lose("glove@here/1", start + seconds(5));
  EXPECT_EQ(view.up("glove", start + seconds(5)), 0u);
  EXPECT_EQ(json::parse(view.json(start + seconds(5)))["services"][0]["state"], "gone");
}

// Two lives of one service: the one that speaks counts.
TEST(StatusView, ARestartedServiceIsUp) {
  StatusView view({"glove"});
  view.hear(status("glove"), start);
  v1::ServiceStatus second = status("glove");
  second.service("glove@here/2");
  view.hear(second, start + seconds(4));
  EXPECT_EQ(view.up("glove", start + seconds(4)), 1u);
  EXPECT_TRUE(view.missing(start + seconds(4)).empty());
}

TEST(StatusView, ClocksAreMeasuredByWhoKnowsMost) {
  StatusView view({});
  view.hear(status("glove"), start);
  view.hear(status("mapping"), start);
  view.hear(beacon("glove"), start);
  view.hear(beacon("mapping", "glove", -0.25), start);
  const std::string page = view.page(start);
  EXPECT_THAT(page, HasSubstr("-0.2500 s ± 200 µs"));
  EXPECT_THAT(page, HasSubstr("the measure"));
  // What was said long ago says nothing.
  EXPECT_THAT(view.page(start + seconds(10)), Not(HasSubstr("the measure")));
}

TEST(StatusView, SaysWhoLeadsAHandAndThatItIsStopped) {
  v1::GateState gate;
  gate.hand("hand");
  gate.leader("mapping@here/1");
  gate.refused("mapping@here/2");
  StatusView view({});
  view.hear(status("simulation"), start);
  view.hear(gate, start);
  EXPECT_THAT(view.page(start), HasSubstr("mapping@here/1 leads; mapping@here/2 is refused"));
  gate.stopped(true);
  gate.stopped_by("operator-anna@here/3");
  gate.reason("a child came in");
  gate.counts().resize(1);
  gate.counts()[0].reason("command while stopped");
  gate.counts()[0].count(7);
  view.hear(gate, start);
  EXPECT_THAT(view.page(start), HasSubstr("STOPPED by operator-anna@here/3: a child came in"));
  const json hand = json::parse(view.json(start))["hands"][0];
  EXPECT_EQ(hand["hand"], "hand");
  EXPECT_EQ(hand["stopped"], true);
  EXPECT_EQ(hand["stopped_by"], "operator-anna@here/3");
  EXPECT_EQ(hand["counts"]["command while stopped"], 7);
  // A gate that has fallen silent says nothing.
  EXPECT_THAT(view.page(start + seconds(4)), Not(HasSubstr("STOPPED")));
}

TEST(StatusView, NothingGrowsWithoutBound) {
  StatusView view({});
  for (int i = 0; i < 3000; ++i) {
    v1::ServiceStatus one = status("service");
    one.service("service@here/" + std::to_string(i));
    view.hear(one, start);
    view.hear(beacon("service" + std::to_string(i)), start);
  }
  EXPECT_EQ(json::parse(view.json(start))["services"].size(), 1000u);
  view.hear(status("glove"), start + seconds(120));
  EXPECT_EQ(json::parse(view.json(start + seconds(120)))["services"].size(), 1u);
}

TEST(StatusView, SaysWhatEachProcessSpeaksWithAndWhoWasNotLetIn) {
  StatusView view({});
  EXPECT_THAT(view.page(start), Not(HasSubstr("DDS")));
  view.refuse({"mapping, which has Fast DDS 3.1.2"});
  EXPECT_THAT(view.page(start), HasSubstr("not let in: mapping, which has Fast DDS 3.1.2\n"));
  view.hear(status("glove"), start, "Fast DDS 2.9.1");
  view.hear(status("simulation"), start);
  const std::string page = view.page(start);
  EXPECT_THAT(page, HasSubstr("DDS\n"));
  EXPECT_THAT(page, HasSubstr(" Fast DDS 2.9.1\n"));
  EXPECT_THAT(page, HasSubstr("not let in: mapping"));
  const json document = json::parse(view.json(start));
  EXPECT_EQ(document["services"][0]["dds"], "Fast DDS 2.9.1");
  EXPECT_EQ(document["services"][1]["dds"], "");
  EXPECT_EQ(document["refused"].size(), 1u);
}

}  // namespace
}  // namespace prehend::cli
