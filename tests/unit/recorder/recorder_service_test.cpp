// A recorder at work in a lab of its own: it records what another participant says until it is told
// to stop, and answers orders. Nothing waits for a time but the end of a run in vain.
#include "services/recorder/service/recorder_service.hpp"

#include <gtest/gtest.h>

#include "common/dds/topics.hpp"
#include "services/recorder/service/tape.hpp"
#include "tests/support/domains/domain_lease.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder {
namespace {

constexpr int max_ticks = 300;  // of 0.1 s

TEST(RecorderService, RecordsWhatIsSaidUntilItIsToldToStop) {
  const test::DomainLease lease;
  const testing::Scratch folder;
  const std::string rig = "recorded";
  const auto shell = service::Shell::create(
      {"--set", "lab.domain=" + std::to_string(lease.domain()), "--set", "lab.rig=" + rig},
      {"recorder", "Records topics.", {}, false});
  ASSERT_TRUE(shell) << shell.error().message();
  const Heading heading{{}, "", [](const std::string&) { return std::nullopt; }};
  auto recorder =
      Recorder::create({.file = folder / "a.mcap", .keep_free = 0}, heading, (*shell)->now());
  ASSERT_TRUE(recorder) << recorder.error().message();

  auto other = dds::Participant::create({.name = "speaker", .domain = lease.domain(), .rig = rig});
  ASSERT_TRUE(other) << other.error().message();
  auto writer = dds::RawWriter::create(*other, dds::raw_topic(dds::grasp_report));
  ASSERT_TRUE(writer) << writer.error().message();
  v1::GraspReport report;
  report.hand("hand");
  dds::RawSample sample;
  sample.payload = dds::encode(dds::grasp_report, report);

  std::unique_ptr<RecorderService> service;
  int ticks = 0;
  const auto tick = [&] {
    writer->write(sample, (*shell)->now());
    if (service->stats().messages < 3 && ++ticks < max_ticks) return;
    EXPECT_FALSE(service->stats().paused);
    EXPECT_EQ(service->execute("pause").value_or(""), "paused");
    EXPECT_TRUE(service->stats().paused);
    EXPECT_EQ(service->execute("resume").value_or(""), "recording");
    EXPECT_FALSE(service->execute("snapshot")) << "it keeps no ring";
    EXPECT_FALSE(service->execute("dance"));
    EXPECT_EQ(service->execute("stop").value_or(""), "stopped");
  };
  auto made = RecorderService::create(**shell, std::move(*recorder),
                                      {.topics = {{"grasp/*"}, {}}, .on_tick = tick});
  ASSERT_TRUE(made) << made.error().message();
  service = std::move(*made);
  ASSERT_TRUE((*shell)->run());
  ASSERT_TRUE(service->finish());

  EXPECT_EQ(service->stats().topics, 1u);
  EXPECT_GE(service->stats().messages, 3u);
  ASSERT_EQ(service->recorder().files().size(), 1u);
  auto tape = Tape::open({folder / "a.mcap"}, [](const std::string&) { return true; });
  ASSERT_TRUE(tape) << tape.error().message();
  ASSERT_EQ(tape->streams().size(), 1u);
  EXPECT_EQ(tape->streams().front()->topic.name, dds::grasp_report.name);
}

}  // namespace
}  // namespace prehend::recorder
