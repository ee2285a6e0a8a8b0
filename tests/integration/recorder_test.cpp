// Recording and replaying with real processes: what was recorded, played and recorded again is the
// same bytes with the same keys, ends, stamps and QoS; killed at any moment the file is readable
// but for its last second; a full disk ends the recording and nothing else; orders come by topic.
#include <sys/mount.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <prehend/dds/raw.hpp>
#include <prehend/mcap/reader.hpp>
#include <prehend/recorder/tape.hpp>
#include <random>

#include "rig.hpp"

namespace prehend::integration {
namespace {

using Kind = dds::RawSample::Kind;
using recorder::Played;
using recorder::Tape;

class Recorder : public Rig {
 protected:
  std::string file(const std::string& name) { return (folder_ / name).string(); }

  service::Process record(const std::string& name, Strings more = {}) {
    Strings arguments = lab_arguments();
    arguments.insert(arguments.end(), {"--output", file(name), "--quiet"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto process = start_program("prehend-record", arguments);
    wait_for("recorder");
    return process;
  }
  service::Process replay(const std::string& name, Strings more = {}) {
    Strings arguments = lab_arguments();
    arguments.insert(arguments.end(), {file(name), "--quiet"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start_program("prehend-replay", arguments);
  }
  void wait_for(const std::string& service) {
    if (!statuses_) statuses_.emplace(reader(dds::service_status));
    ASSERT_TRUE(hear<v1::ServiceStatus>(*statuses_, 20, [&](const v1::ServiceStatus& status) {
      return status.name().to_string() == service;
    }));
  }
  /// Publishes until the program on the other side has matched the writer.
  template <class T>
  static void meet(dds::Writer<T>& writer, int readers = 1) {
    ASSERT_TRUE(eventually(10, [&] {
      eprosima::fastdds::dds::PublicationMatchedStatus status;
      writer.raw().get_publication_matched_status(status);
      return status.current_count >= readers;
    }));
  }
  template <class P>
  dds::Writer<typename P::type> writer(const dds::Topic<P>& topic) {
    auto made = participant_->writer(topic);
    if (!made) throw std::runtime_error(made.error().message());
    return std::move(*made);
  }
  /// Sends an order and returns the reply.
  v1::OperatorReply order(const std::string& target, const std::string& argument) {
    if (!orders_) {
      orders_.emplace(writer(dds::operator_command));
      replies_.emplace(reader(dds::operator_reply));
    }
    v1::OperatorCommand command;
    const std::string id = "order-" + std::to_string(++order_count_);
    command.id(id);
    command.stamp_ns(now_ns());
    command.action(v1::ACTION_START);
    command.target(target);
    command.argument(argument);
    std::optional<v1::OperatorReply> reply;
    // Again until the program has found us: obeying twice does not matter to these orders.
    eventually(15, [&] {
      orders_->write(command);
      reply = hear<v1::OperatorReply>(
          *replies_, 0.5, [&](const v1::OperatorReply& one) { return one.id().to_string() == id; });
      return reply.has_value();
    });
    EXPECT_TRUE(reply) << argument;
    return reply.value_or(v1::OperatorReply());
  }
  static std::vector<Played> content(const std::string& path, const std::string& topic = "") {
    auto tape = Tape::open({path}, [&](const std::string& name) {
      return topic.empty() ? !name.starts_with("service/") && !name.starts_with("operator/")
                           : name == topic;
    });
    EXPECT_TRUE(tape) << tape.error().message();
    std::vector<Played> all;
    while (tape) {
      auto one = tape->next();
      if (!one) break;
      all.push_back(std::move(*one));
    }
    if (tape) tapes_.push_back(std::move(*tape));  // owns the streams
    return all;
  }
  static v1::ObjectDetection detection(std::uint32_t track, std::uint64_t number) {
    v1::ObjectDetection message;
    message.track(track);
    message.sequence_number(number);
    message.stamp_ns(now_ns());
    message.name("Cup");
    return message;
  }
  int end(service::Process& process) {
    process.signal(SIGTERM);
    const auto exit = process.wait(seconds(20));
    return exit ? exit->code : -1;
  }

  std::optional<dds::Reader<v1::ServiceStatus>> statuses_;
  std::optional<dds::Writer<v1::OperatorCommand>> orders_;
  std::optional<dds::Reader<v1::OperatorReply>> replies_;
  int order_count_ = 0;
  static inline std::vector<Tape> tapes_;
};

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
    v1::LabClock tick;
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

TEST_F(Recorder, KilledAtAnyMomentItsFileIsReadableButForTheLastSecond) {
  const int points = std::getenv("PREHEND_LONG") ? 200 : 20;
  std::mt19937 random(std::random_device{}());
  // Volatile: a late recorder of a topic that keeps all is first given what was before.
  auto postures = writer(dds::hand_posture);
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::map<std::uint64_t, std::int64_t> sent;  // number: when
  std::thread source([&] {
    for (std::uint64_t i = 0; !stop; ++i) {
      v1::HandPosture posture;
      posture.glove("glove");
      posture.sequence_number(i);
      posture.stamp_ns(now_ns());
      postures.write(posture);
      {
        const std::scoped_lock lock(mutex);
        sent[i] = posture.stamp_ns();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  for (int point = 0; point < points; ++point) {
    const std::string name = "killed-" + std::to_string(point) + ".mcap";
    Strings arguments = lab_arguments();
    arguments.insert(arguments.end(), {"--output", file(name), "--quiet"});
    auto process = start_program("prehend-record", arguments);
    ASSERT_TRUE(eventually(20, [&] {
      std::error_code ignored;
      return std::filesystem::exists(file(name)) &&
             std::filesystem::file_size(file(name), ignored) > 20'000;
    }));
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 700'000));
    const std::int64_t killed = now_ns();
    process.signal(SIGKILL);
    process.wait(seconds(5));
    auto tape = Tape::open({file(name)}, [](const std::string& t) { return t == "hand/posture"; });
    ASSERT_TRUE(tape) << tape.error().message();
    std::int64_t last = 0;
    std::uint64_t count = 0;
    while (const auto one = tape->next()) {
      v1::HandPosture posture;
      ASSERT_TRUE(dds::decode(dds::hand_posture, one->sample, posture));
      last = std::max(last, posture.stamp_ns());
      ++count;
    }
    EXPECT_GT(count, 0u);
    EXPECT_GT(last, killed - 1'000'000'000) << "more than a second is gone";
    std::filesystem::remove(file(name));
  }
  stop = true;
  source.join();
}

TEST_F(Recorder, OnAFullDiskItEndsCleanlyAndSaysSo) {
  const auto disk = folder_ / "disk";
  std::filesystem::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=1m") != 0)
    GTEST_SKIP() << "a small file system cannot be mounted here";
  {
    auto process = record("disk/full.mcap", {"--keep-free", "0", "--compression", "none"});
    auto images = writer(dds::camera_image);
    meet(images);
    v1::CameraImage image;
    image.camera("camera");
    image.data(std::vector<std::uint8_t>(60'000, 7));
    ASSERT_TRUE(eventually(20, [&] {
      images.write(image);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      return process.exit().has_value();
    }));
    EXPECT_EQ(process.exit()->code, 3);
    const std::string said = service::last_lines(folder_ / "prehend-record.log", 10);
    EXPECT_NE(said.find("No space left"), std::string::npos) << said;
    const auto kept = content((disk / "full.mcap").string(), "camera/image");
    EXPECT_GT(kept.size(), 5u);
    for (const Played& one : kept) EXPECT_GT(one.sample.payload.size(), 60'000u);
    tapes_.clear();
  }
  ::umount2(disk.c_str(), MNT_DETACH);
}

TEST_F(Recorder, ASplitRecordingBeginsWithWhatALateReaderWouldGet) {
  auto scenes = writer(dds::scene_state);
  v1::SceneState scene;
  scene.scene("table");
  scene.sequence_number(42);
  ASSERT_TRUE(scenes.write(scene));
  auto process = record("split.mcap", {"--split-size", "0.05", "--compression", "none"});
  auto images = writer(dds::camera_image);
  meet(images);
  v1::CameraImage image;
  image.camera("camera");
  image.data(std::vector<std::uint8_t>(10'000, 7));
  ASSERT_TRUE(eventually(20, [&] {
    images.write(image);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return std::filesystem::exists(file("split_2.mcap"));
  }));
  ASSERT_EQ(end(process), 0);
  for (const char* name : {"split.mcap", "split_1.mcap", "split_2.mcap"}) {
    const auto scenes_there = content(file(name), "scene/state");
    ASSERT_EQ(scenes_there.size(), 1u) << name;
    v1::SceneState there;
    ASSERT_TRUE(dds::decode(dds::scene_state, scenes_there[0].sample, there));
    EXPECT_EQ(there.sequence_number(), 42u);
  }
}

TEST_F(Recorder, SnapshotPauseAndStopByTopic) {
  auto process = record("ring.mcap", {"--snapshot", "30"});
  auto reports = writer(dds::grasp_report);
  meet(reports);
  v1::GraspReport report;
  report.hand("hand");
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(reports.write(report));
  // An order is itself a topic: when it is answered, what was before has come.
  const auto unknown = order("recorder", "sing");
  EXPECT_FALSE(unknown.done());
  EXPECT_NE(unknown.message().to_string().find("snapshot"), std::string::npos);
  std::string path;
  ASSERT_TRUE(eventually(10, [&] {
    const auto written = order("recorder", "snapshot");
    path = written.message().to_string();
    return written.done() && content(path, "grasp/report").size() == 10;
  }));
  EXPECT_FALSE(std::filesystem::exists(file("ring.mcap")));
  EXPECT_TRUE(order("recorder", "pause").done());
  EXPECT_TRUE(order("recorder", "stop").done());
  const auto exit = process.wait(seconds(10));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0);
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

  auto heard = participant_->reader(dds::Topic<v1::GraspReportPubSubType>{"grasp/report"});
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
  for (const char* command : {"replay", "check"})
    for (const char* name : {"broken.mcap", "missing.mcap"}) {
      const Answer answer = run("prehend", {command, file(name), "--quiet"}, 20);
      EXPECT_EQ(answer.exit_code, 3) << answer.log;
      EXPECT_NE(answer.log.find(name), std::string::npos) << answer.log;
    }
}

TEST_F(Recorder, SamplesAreAnsweredAsRecordedTimeAndAgain) {
  const int runs = std::getenv("PREHEND_LONG") ? 20 : 2;
  const std::string samples = std::string(PREHEND_SOURCE) + "/deploy/samples";
  std::uintmax_t bytes = 0;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(samples)) {
    if (entry.path().extension() != ".mcap") continue;
    bytes += entry.file_size();
    ++count;
    std::string first;
    for (int i = 0; i < runs; ++i) {
      const Answer answer = run("prehend",
                                {"check", entry.path().string(), "--json", "--domain",
                                 std::to_string(domain_), "--junit", file("junit.xml")},
                                120);
      ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
      const auto document = nlohmann::json::parse(answer.output);
      EXPECT_EQ(document["verdict"], "same");
      if (i == 0) first = answer.output;
      EXPECT_EQ(answer.output, first);
    }
    EXPECT_TRUE(std::filesystem::exists(file("junit.xml")));
  }
  EXPECT_GE(count, 2);
  EXPECT_LT(bytes, 2'000'000u);
}

TEST_F(Recorder, ACheckSeesWhatHasChangedAndUpdateTakesItOver) {
  const std::string sample = file("sample.mcap");
  std::filesystem::copy_file(std::string(PREHEND_SOURCE) + "/deploy/samples/direct-grasp.mcap",
                             sample);
  // Another wearer: the fingertips are meant for a hand of another size.
  const Strings changed{"check",
                        sample,
                        "--json",
                        "--service",
                        "glove",
                        "--set",
                        "glove.user=somebody else",
                        "--domain",
                        std::to_string(domain_)};
  const Answer answer = run("prehend", changed, 60);
  EXPECT_EQ(answer.exit_code, 1) << answer.output << answer.log;
  const auto document = nlohmann::json::parse(answer.output);
  EXPECT_EQ(document["verdict"], "different");
  EXPECT_EQ(document["topics"][0]["name"], "hand/posture");
  EXPECT_NE(document["topics"][0]["first_difference"].get<std::string>().find("user"),
            std::string::npos);
  Strings updating = changed;
  updating.push_back("--update");
  EXPECT_EQ(run("prehend", updating, 60).exit_code, 0);
  EXPECT_EQ(run("prehend", changed, 60).exit_code, 0);
}

}  // namespace
}  // namespace prehend::integration
