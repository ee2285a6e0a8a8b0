// Replaying and checking with real processes: what was recorded, played and recorded again is the
// same bytes with the same keys, ends, stamps and QoS; orders come by topic; samples are answered
// as recorded.
#include <algorithm>
#include <fstream>
#include <map>

#include "tests/integration/recorder_rig.hpp"

namespace prehend::integration {
namespace {

class Recorder : public RecorderRig {};

TEST_F(Recorder, RecordedPlayedAndRecordedAgainIsTheSame) {
  auto first = record("first.mcap");
  auto detections = writer(dds::object_detection);
  auto reports = writer(dds::grasp_report);
  meet(detections);
  meet(reports);
  auto clock = writer(dds::lab_clock);  // without key, and late: the recorder is at work
  meet(clock);
  for (std::uint64_t i = 0; i < 40; ++i) {
    ASSERT_TRUE(detections.write(detection(static_cast<std::uint32_t>(i % 3), i)));
    if (i % 10 == 9) {
      ASSERT_TRUE(detections.dispose(detection(static_cast<std::uint32_t>(i % 3), 0)));
    }
    v1::GraspReport report;
    report.hand("hand");
    report.sequence_number(i);
    ASSERT_TRUE(reports.write(report));
    v2::LabClock tick;
    tick.cycle(i + 1);
    ASSERT_TRUE(clock.write(tick));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(end(first), 0);
  const auto recorded = content(file("first.mcap"));
  ASSERT_EQ(recorded.size(), 40u * 3 + 4);

  // Elsewhere, where the typed writers above are not heard.
  const Strings elsewhere{"--set", "lab.rig=" + name_ + "-again"};
  Strings arguments = lab_arguments();
  arguments.insert(arguments.end(), elsewhere.begin(), elsewhere.end());
  Strings record_arguments = arguments, replay_arguments = arguments;
  record_arguments.insert(record_arguments.end(), {"--output", file("second.mcap"), "--quiet"});
  replay_arguments.insert(replay_arguments.end(), {file("first.mcap"), "--quiet", "--delay", "2"});
  auto second = start_program("prehend-record", record_arguments);
  ASSERT_TRUE(eventually(10, [&] { return std::filesystem::exists(file("second.mcap")); }));
  auto player = start_program("prehend-replay", replay_arguments);
  const auto exit = player.wait(seconds(30));
  ASSERT_TRUE(exit && exit->code == 0);
  ASSERT_EQ(end(second), 0);
  const auto again = content(file("second.mcap"));
  ASSERT_EQ(again.size(), recorded.size());
  // Topic by topic: the order among topics is that of arrival.
  std::map<std::string, std::vector<const Played*>> before, after;
  for (const Played& one : recorded) before[one.stream->topic.name].push_back(&one);
  for (const Played& one : again) after[one.stream->topic.name].push_back(&one);
  for (const auto& [topic, list] : before) {
    ASSERT_EQ(after[topic].size(), list.size()) << topic;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Played &a = *list[i], &b = *after[topic][i];
      EXPECT_EQ(b.sample.kind, a.sample.kind) << topic << i;
      EXPECT_EQ(b.sample.payload, a.sample.payload) << topic << i;
      EXPECT_EQ(b.sample.instance, a.sample.instance) << topic << i;
      EXPECT_EQ(b.sample.sent, a.sample.sent) << topic << i;
      EXPECT_EQ(b.stream->topic.type, a.stream->topic.type);
      EXPECT_EQ(b.stream->topic.keyed, a.stream->topic.keyed);
      EXPECT_EQ(recording::to_text(b.stream->topic.qos), recording::to_text(a.stream->topic.qos));
    }
  }
}

TEST_F(Recorder, APlayerIsPausedSteppedSoughtAndStoppedByTopic) {
  auto process = record("tape.mcap", {"grasp/report"});
  auto reports = writer(dds::grasp_report);
  meet(reports);
  v1::GraspReport report;
  report.hand("hand");
  for (std::uint64_t i = 0; i < 50; ++i) {
    report.sequence_number(i);
    ASSERT_TRUE(reports.write(report));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ASSERT_EQ(end(process), 0);
  const auto recorded = content(file("tape.mcap"));
  ASSERT_EQ(recorded.size(), 50u);

  auto heard = participant_->reader(dds::grasp_report);
  ASSERT_TRUE(heard);
  heard->raw().wait_for_unread_message({2, 0});
  while (!heard->take().empty()) {  // our own, kept for late readers
  }
  auto player = replay("tape.mcap", {"--paused"});
  const auto hear_number = [&](std::uint64_t number) {
    return hear<v1::GraspReport>(
               *heard, 10,
               [&](const v1::GraspReport& one) { return one.sequence_number() == number; })
        .has_value();
  };
  EXPECT_TRUE(order("replayer", "pause").done());
  EXPECT_TRUE(order("replayer", "seek 0.5").done());
  std::uint64_t next = 0;  // the first one at or behind 0.5 s
  while (recorded[next].log_time - recorded[0].log_time < seconds(0.5)) ++next;
  EXPECT_TRUE(order("replayer", "burst 1").done());
  EXPECT_TRUE(hear_number(next));
  EXPECT_TRUE(order("replayer", "rate 50").done());
  EXPECT_FALSE(order("replayer", "rate -1").done());
  EXPECT_FALSE(order("replayer", "seek x").done());
  EXPECT_TRUE(order("replayer", "seek 0").done());
  EXPECT_TRUE(order("replayer", "start").done());
  EXPECT_TRUE(hear_number(49));
  const auto exit = player.wait(seconds(10));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0);
}

TEST_F(Recorder, WrongUseAndBrokenRecordingsAreOneClearLine) {
  for (const Strings& arguments :
       {Strings{"record"}, Strings{"record", "-o", file("x.mcap"), "--split-size", "none"},
        Strings{"record", "-o", file("x.mcap"), "--set", "glove.colour=red"}, Strings{"replay"},
        Strings{"replay", file("x.mcap"), "--rate", "0"}, Strings{"check"},
        Strings{"check", file("x.mcap"), "--service", "coffee"}}) {
    const Answer answer = run("prehend", arguments, 20);
    EXPECT_EQ(answer.exit_code, 2) << arguments.front() << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1) << answer.log;
    EXPECT_EQ(answer.output, "");
  }
  std::ofstream(file("broken.mcap")) << "this is no recording";
  const Answer taken = run("prehend", with_lab({"record", "-o", file("broken.mcap")}), 20);
  EXPECT_EQ(taken.exit_code, 2) << taken.log;
  EXPECT_NE(taken.log.find("broken.mcap: is there already (choose another name, or give --force)"),
            std::string::npos)
      << taken.log;
  for (const char* command : {"replay", "check"})
    for (const char* name : {"broken.mcap", "missing.mcap"}) {
      const Answer answer = run("prehend", {command, file(name), "--quiet"}, 20);
      EXPECT_EQ(answer.exit_code, 3) << answer.log;
      EXPECT_NE(answer.log.find(name), std::string::npos) << answer.log;
    }
}

}  // namespace
}  // namespace prehend::integration
