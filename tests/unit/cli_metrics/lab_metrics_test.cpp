// What services say of themselves as metrics: every number is there, in a page that a reader of the
// format takes, whatever names others give to things.
#include "services/cli/tools/metrics/lab_metrics.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/metrics/page.hpp"

namespace prehend::cli {
namespace {

using tests::MetricsPage;

const Time begin = from_ns(1'700'000'000'000'000'000);

v1::ServiceStatus status_of(const std::string& name, int pid, double uptime = 10) {
  v1::ServiceStatus status;
  status.service((name + "@lab/" + std::to_string(pid)).c_str());
  status.name(name.c_str());
  status.host("lab");
  status.state(v1::STATE_RUNNING);
  status.uptime(uptime);
  status.resident(5e7);
  return status;
}

v1::GateState gate_of(const std::string& hand) {
  v1::GateState gate;
  gate.hand(hand.c_str());
  gate.obeyed(7);
  return gate;
}

MetricsPage page_of(const LabMetrics& metrics, Time now) {
  auto page = MetricsPage::parse(metrics.text(now));
  if (!page) throw std::runtime_error(page.error().message() + "\n" + metrics.text(now));
  return *page;
}

double value(const MetricsPage& page, const std::string& name, const std::string& labels) {
  const auto found = page.value(name, labels);
  if (!found) ADD_FAILURE() << found.error().message();
  return found.value_or(std::numeric_limits<double>::quiet_NaN());
}

TEST(LabMetrics, AnEmptyLabMissesWhatItExpects) {
  const LabMetrics metrics({"glove", "mapping"});
  const MetricsPage page = page_of(metrics, begin);
  EXPECT_EQ(value(page, "prehend_processes", "service=\"glove\""), 0);
  EXPECT_EQ(value(page, "prehend_processes", "service=\"mapping\""), 0);
  EXPECT_EQ(page.samples.size(), 2u);
}

TEST(LabMetrics, AServiceIsToldWhole) {
  LabMetrics metrics({"mapping"});
  v1::ServiceStatus status = status_of("mapping", 42);
  v1::Rate rate;
  rate.name("commands");
  rate.total(9'007'199'254'740'993);  // no double holds it
  rate.per_second(29.5);
  status.rates().push_back(rate);
  v1::Drop drop;
  drop.reason("stale");
  drop.count(3);
  status.drops().push_back(drop);
  v1::StageLatency stage;
  stage.stage("glove to command");
  stage.p50_us(1500);
  stage.p99_us(4000);
  stage.max_us(9000);
  stage.count(1024);
  status.latency().push_back(stage);
  stage.stage("never");
  stage.count(0);
  status.latency().push_back(stage);
  metrics.hear(status, begin);
  const MetricsPage page = page_of(metrics, begin);
  const std::string who = "{service=\"mapping\",host=\"lab\",pid=\"42\"";
  EXPECT_EQ(value(page, "prehend_up", who), 1);
  EXPECT_EQ(value(page, "prehend_state", who + ",state=\"running\""), 1);
  EXPECT_EQ(value(page, "prehend_state", who + ",state=\"degraded\""), 0);
  EXPECT_EQ(value(page, "prehend_uptime_seconds", who), 10);
  EXPECT_EQ(value(page, "prehend_resident_bytes", who), 5e7);
  EXPECT_NE(metrics.text(begin).find("event=\"commands\"} 9007199254740993\n"), std::string::npos);
  EXPECT_EQ(value(page, "prehend_events_per_second", who), 29.5);
  EXPECT_EQ(value(page, "prehend_drops_total", who + ",reason=\"stale\""), 3);
  EXPECT_DOUBLE_EQ(value(page, "prehend_latency_seconds", "quantile=\"0.99\""), 0.004);
  EXPECT_DOUBLE_EQ(value(page, "prehend_latency_seconds", "quantile=\"1\""), 0.009);
  EXPECT_FALSE(page.value("prehend_latency_seconds", "never"));
  EXPECT_EQ(value(page, "prehend_processes", "mapping"), 1);
}

TEST(LabMetrics, WhoIsSilentOrGoneIsDownAndLaterForgotten) {
  LabMetrics metrics({"glove", "mapping"});
  metrics.hear(status_of("glove", 1), begin);
  metrics.hear(status_of("mapping", 2), begin);
  metrics.lose_service("glove@lab/1");
  MetricsPage page = page_of(metrics, begin + seconds(1));
  EXPECT_EQ(value(page, "prehend_up", "glove"), 0);
  EXPECT_EQ(value(page, "prehend_up", "mapping"), 1);
  EXPECT_EQ(value(page, "prehend_processes", "glove"), 0);
  EXPECT_FALSE(page.value("prehend_uptime_seconds", "glove"))
      << "what was is not told as if it were";
  page = page_of(metrics, begin + seconds(4));
  EXPECT_EQ(value(page, "prehend_up", "mapping"), 0);
  metrics.hear(status_of("mapping", 3), begin + seconds(100));
  page = page_of(metrics, begin + seconds(100));
  EXPECT_FALSE(page.value("prehend_up", "pid=\"2\""));
}

TEST(LabMetrics, StartsAreCounted) {
  LabMetrics metrics({});
  const auto starts = [&](Time now) {
    return value(page_of(metrics, now), "prehend_starts_total", "glove");
  };
  metrics.hear(status_of("glove", 1, 10), begin);
  metrics.hear(status_of("glove", 1, 11), begin + seconds(1));
  EXPECT_EQ(starts(begin + seconds(1)), 1);
  metrics.hear(status_of("glove", 1, 0.5), begin + seconds(2));
  EXPECT_EQ(starts(begin + seconds(2)), 2) << "anew in its place";
  metrics.hear(status_of("glove", 9, 0), begin + seconds(3));
  EXPECT_EQ(starts(begin + seconds(3)), 3);
  EXPECT_EQ(starts(begin + seconds(500)), 3) << "a count does not go back";
}

TEST(LabMetrics, ClocksAndPeers) {
  LabMetrics metrics({});
  v1::ClockBeacon beacon;
  beacon.service("glove@lab/1");
  beacon.step_ns(-1'500'000'000);
  v1::ClockPeer peer;
  peer.known(true);
  beacon.peers().push_back(peer);
  beacon.peers().push_back(peer);
  peer.known(false);
  beacon.peers().push_back(peer);
  metrics.hear(beacon, begin);
  const MetricsPage page = page_of(metrics, begin);
  EXPECT_EQ(value(page, "prehend_peers", "glove"), 2);
  EXPECT_EQ(value(page, "prehend_clock_step_seconds", "glove"), -1.5);
}

TEST(LabMetrics, AGateIsToldWholeAndAStopWithItsReason) {
  LabMetrics metrics({});
  v1::GateState gate = gate_of("hand");
  gate.leader("mapping@lab/1");
  v1::GateCount count;
  count.reason("old");
  count.count(12);
  gate.counts().push_back(count);
  metrics.hear(gate, begin);
  MetricsPage page = page_of(metrics, begin);
  EXPECT_EQ(value(page, "prehend_gate_up", "hand"), 1);
  EXPECT_EQ(value(page, "prehend_gate_led", "hand"), 1);
  EXPECT_EQ(value(page, "prehend_gate_stopped", "hand"), 0);
  EXPECT_EQ(value(page, "prehend_gate_obeyed_total", "hand"), 7);
  EXPECT_EQ(value(page, "prehend_gate_refusals_total", "reason=\"old\""), 12);
  EXPECT_FALSE(page.value("prehend_gate_stop_info"));
  gate.stopped(true);
  gate.stopped_by("operator@desk/9");
  gate.reason("a \"hand\"\nin the cell\\");
  metrics.hear(gate, begin);
  page = page_of(metrics, begin);
  EXPECT_EQ(value(page, "prehend_gate_stopped", "hand"), 1);
  EXPECT_EQ(value(page, "prehend_gate_stop_info", R"(reason="a \"hand\"\nin the cell\\")"), 1);
  page = page_of(metrics, begin + seconds(4));
  EXPECT_EQ(value(page, "prehend_gate_up", "hand"), 0);
  EXPECT_FALSE(page.value("prehend_gate_stopped")) << "nobody says so any more";
  metrics.lose_gate("hand");
  EXPECT_EQ(value(page_of(metrics, begin), "prehend_gate_up", "hand"), 0);
}

TEST(LabMetrics, NamesOfOthersBreakNoLine) {
  LabMetrics metrics({"a\"b"});
  v1::ServiceStatus status = status_of("x\"} 1\nprehend_up{", 1);
  for (const char* reason : {"\xff\xfe", "a\\", "tab\t\x1b[2J", "", "same", "same"}) {
    v1::Drop drop;
    drop.reason(reason);
    drop.count(2);
    status.drops().push_back(drop);
  }
  status.uptime(std::numeric_limits<double>::infinity());
  status.resident(std::numeric_limits<double>::quiet_NaN());
  metrics.hear(status, begin);
  status.service("no key");
  metrics.hear(status, begin);
  const std::string text = metrics.text(begin);
  EXPECT_NE(text.find("reason=\"same\"} 4\n"), std::string::npos) << "one sample of both";
  EXPECT_NE(text.find("prehend_uptime_seconds{service=\"no key\",host=\"\",pid=\"\"} +Inf\n"),
            std::string::npos);
  EXPECT_NE(text.find("} NaN\n"), std::string::npos);
  std::string finite = text;
  for (const char* word : {"+Inf", "NaN"})
    for (std::size_t at; (at = finite.find(word)) != std::string::npos;)
      finite.replace(at, std::string(word).size(), "0");
  const auto page = MetricsPage::parse(finite);
  EXPECT_TRUE(page) << page.error().message();
}

TEST(LabMetrics, ACrowdDoesNotGrowThePageWithoutEnd) {
  LabMetrics metrics({});
  for (int i = 0; i < 1000; ++i) {
    metrics.hear(status_of("glove" + std::to_string(i), i), begin);
    metrics.hear(gate_of("hand" + std::to_string(i)), begin);
  }
  EXPECT_LT(metrics.text(begin).size(), 200'000u);
}

}  // namespace
}  // namespace prehend::cli
