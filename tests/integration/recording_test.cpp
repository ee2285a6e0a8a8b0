// Recording with real processes: killed at any moment the file is readable but for its last second;
// a full disk ends the recording and nothing else; files are split, rotated and begin with what a
// late reader would get; orders come by topic, key and signal; what is chosen is recorded, and what
// was lost is counted.
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "common/recording/mcap/reader.hpp"
#include "tests/integration/recorder_rig.hpp"
#include "tests/integration/terminal.hpp"

namespace prehend::integration {
namespace {

using Kind = dds::RawSample::Kind;

class Recording : public RecorderRig {
 protected:
  static v1::CameraImage image(std::size_t bytes, std::uint64_t number = 0) {
    v1::CameraImage made;
    made.camera("camera");
    made.sequence_number(number);
    made.data(std::vector<std::uint8_t>(bytes, 7));
    return made;
  }
  nlohmann::json info(const std::string& path) {
    const Answer answer = run("prehend", {"recording", "info", path, "--json"}, 20);
    EXPECT_EQ(answer.exit_code, 0) << answer.log;
    return nlohmann::json::parse(answer.output);
  }
  /// Topics with the number of their samples.
  std::map<std::string, int> counts(const std::string& path) {
    std::map<std::string, int> all;
    const auto document = info(path);
    for (const auto& topic : document["topics"]) all[topic["name"]] = topic["count"];
    return all;
  }
  /// How many samples of a topic have been written out to a file that is still being written.
  static std::uint64_t written(const std::string& path, const std::string& topic) {
    auto reader = recording::mcap::Reader::open(path);
    if (!reader) return 0;
    const auto& statistics = reader->statistics();
    std::uint64_t sum = 0;
    for (const auto& [id, channel] : reader->contents().channels)
      for (const auto& [counted, count] : statistics.channel_message_counts)
        if (counted == id && channel.topic == topic) sum += count;
    return sum;
  }
  template <class P>
  static typename P::type decoded(const dds::Topic<P>& topic, const Played& one) {
    typename P::type message;
    EXPECT_TRUE(dds::decode(topic, one.sample, message));
    return message;
  }
};

TEST_F(Recording, KilledAtAnyMomentItsFileIsReadableButForTheLastSecond) {
  const int points = std::getenv("PREHEND_LONG") ? 200 : 20;
  std::mt19937 random(std::random_device{}());
  // Volatile: a late recorder of a topic that keeps all is first given what was before.
  auto postures = writer(dds::hand_posture);
  const std::jthread source([&](const std::stop_token& stop) {
    for (std::uint64_t i = 0; !stop.stop_requested(); ++i) {
      v1::HandPosture posture;
      posture.glove("glove");
      posture.sequence_number(i);
      posture.stamp_ns(now_ns());
      postures.write(posture);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  for (int point = 0; point < points; ++point) {
    const std::string name = "killed-" + std::to_string(point) + ".mcap";
    Strings arguments = lab_arguments();
    arguments.insert(arguments.end(), {"--output", file(name), "--quiet"});
    auto process = start_program("prehend-record", arguments);
    ASSERT_TRUE(eventually(20, [&] { return written(file(name), "hand/posture") > 0; }));
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 700'000));
    const std::int64_t killed = now_ns();
    process.signal(SIGKILL);
    process.wait(seconds(5));
    auto tape = recorder::Tape::open({file(name)},
                                     [](const std::string& t) { return t == "hand/posture"; });
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
}

TEST_F(Recording, OnAFullDiskItEndsCleanlyAndSaysSo) {
  const auto disk = folder_ / "disk";
  std::filesystem::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=4m") != 0)
    GTEST_SKIP() << "a small file system cannot be mounted here";
  {
    auto process = record("disk/full.mcap", {"--keep-free", "0", "--compression", "none"});
    auto images = writer(dds::camera_image);
    meet(images);
    ASSERT_TRUE(eventually(20, [&] {
      images.write(image(60'000));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      return process.exit().has_value();
    }));
    EXPECT_EQ(process.exit()->code, 3);
    const std::string said = stage::last_lines(folder_ / "prehend-record.log", 10);
    EXPECT_NE(said.find("No space left"), std::string::npos) << said;
    const auto kept = content((disk / "full.mcap").string(), "camera/image");
    EXPECT_GT(kept.size(), 5u);
    for (const Played& one : kept) EXPECT_GT(one.sample.payload.size(), 60'000u);
    tapes_.clear();
  }
  ::umount2(disk.c_str(), MNT_DETACH);
}

TEST_F(Recording, ASplitRecordingBeginsWithWhatALateReaderWouldGet) {
  auto scenes = writer(dds::scene_state);
  v1::SceneState scene;
  scene.scene("table");
  scene.sequence_number(42);
  ASSERT_TRUE(scenes.write(scene));
  auto process = record("split.mcap", {"--split-size", "0.05", "--compression", "none"});
  auto images = writer(dds::camera_image);
  meet(images);
  ASSERT_TRUE(eventually(20, [&] {
    images.write(image(10'000));
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

TEST_F(Recording, SnapshotPauseAndStopByTopic) {
  auto process = record("ring.mcap", {"--snapshot", "30"});
  auto reports = writer(dds::grasp_report);
  meet(reports);
  v1::GraspReport report;
  report.hand("hand");
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(reports.write(report));
  const auto unknown = order("recorder", "sing");
  EXPECT_FALSE(unknown.done());
  EXPECT_NE(unknown.message().to_string().find("snapshot"), std::string::npos);
  // A busy recorder may answer the order before it has taken the reports.
  ASSERT_TRUE(eventually(10, [&] {
    const auto snapshot = order("recorder", "snapshot");
    return written(snapshot.message().to_string(), "grasp/report") == 10;
  }));
  EXPECT_FALSE(std::filesystem::exists(file("ring.mcap")));
  EXPECT_TRUE(order("recorder", "pause").done());
  EXPECT_TRUE(order("recorder", "stop").done());
  const auto exit = process.wait(seconds(10));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0);
}

TEST_F(Recording, OfASplitRecordingOnlyTheNewestFilesAreKept) {
  auto process = record("ring.mcap", {"--split-size", "0.05", "--keep", "2", "--compression",
                                      "none", "camera/image"});
  auto images = writer(dds::camera_image);
  meet(images);
  std::uint64_t sent = 0;
  ASSERT_TRUE(eventually(20, [&] {
    images.write(image(10'000, sent++));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return std::filesystem::exists(file("ring_4.mcap"));
  }));
  ASSERT_EQ(end(process), 0);
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    if (entry.path().extension() == ".mcap") files.insert(entry.path().filename());
  EXPECT_EQ(files.size(), 2u);
  std::vector<std::uint64_t> numbers;
  for (const std::string& name : files)
    for (const Played& one : content(file(name), "camera/image"))
      numbers.push_back(decoded(dds::camera_image, one).sequence_number());
  // Without a gap up to the last one.
  ASSERT_FALSE(numbers.empty());
  EXPECT_EQ(numbers.back(), sent - 1);
  for (std::size_t i = 1; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], numbers[i - 1] + 1);
}

TEST_F(Recording, SplitByTimeNothingIsMissingAndNothingDouble) {
  // The topic alone: a beacon of the clocks might begin a part in which no posture comes any more.
  auto process = record("split.mcap", {"--split-time", "0.2", "hand/posture"});
  auto postures = writer(dds::hand_posture);
  meet(postures);
  // Nothing comes for longer than a part lasts: an empty part was left behind.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  v1::HandPosture posture;
  posture.glove("glove");
  std::uint64_t sent = 0;
  ASSERT_TRUE(eventually(20, [&] {
    posture.sequence_number(sent++);
    postures.write(posture);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return std::filesystem::exists(file("split_2.mcap"));
  }));
  ASSERT_EQ(end(process), 0);
  std::uint64_t next = 0;
  for (const char* name : {"split.mcap", "split_1.mcap", "split_2.mcap"}) {
    const auto part = content(file(name), "hand/posture");
    ASSERT_FALSE(part.empty()) << name;
    EXPECT_LT(part.back().log_time - part.front().log_time, seconds(0.2));
    for (const Played& one : part)
      ASSERT_EQ(decoded(dds::hand_posture, one).sequence_number(), next++) << name;
  }
  EXPECT_EQ(next, sent);
}

TEST_F(Recording, EndsBeforeTheDiskIsFull) {
  // Started without `record`: it ends at once, perhaps before anybody has heard that it runs.
  Strings arguments = lab_arguments();
  arguments.insert(arguments.end(),
                   {"--output", file("guarded.mcap"), "--quiet", "--keep-free", "1e9"});
  auto process = start_program("prehend-record", arguments);
  const auto exit = process.wait(seconds(20));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 3);
  const std::string said = stage::last_lines(folder_ / "prehend-record.log", 10);
  EXPECT_NE(said.find("are free on the disk"), std::string::npos) << said;
  EXPECT_NE(said.find("--keep-free"), std::string::npos) << said;
  EXPECT_TRUE(info(file("guarded.mcap"))["closed"]);
}

TEST_F(Recording, SignalsEndTheFileProperly) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string name = std::to_string(signal) + ".mcap";
    auto process = record(name, {"grasp/report"});
    auto reports = writer(dds::grasp_report);
    meet(reports);
    v1::GraspReport report;
    report.hand("hand");
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(reports.write(report));
    ASSERT_TRUE(dds::succeeded(reports.raw().wait_for_acknowledgments({5, 0})));
    EXPECT_EQ(end(process, signal), 0);
    const auto document = info(file(name));
    EXPECT_TRUE(document["closed"]);
    EXPECT_EQ(document["damage"].size(), 0u) << document;
    EXPECT_GE(document["messages"], 20);
  }
}

TEST_F(Recording, KeysOnATerminalPauseWriteASnapshotAndQuit) {
  Strings arguments = lab_arguments();
  arguments.insert(arguments.end(), {"--output", file("ring.mcap"), "--snapshot", "30"});
  Terminal terminal(program("prehend-record"), arguments);
  ASSERT_TRUE(terminal.shows("recording ")) << terminal.shown();
  EXPECT_FALSE(terminal.is_a_shells());
  auto reports = writer(dds::grasp_report);
  meet(reports);
  v1::GraspReport report;
  report.hand("hand");
  ASSERT_TRUE(reports.write(report));
  ASSERT_TRUE(dds::succeeded(reports.raw().wait_for_acknowledgments({5, 0})));
  terminal.press(" ");
  EXPECT_TRUE(terminal.shows("paused ")) << terminal.shown();
  terminal.press(" ");
  EXPECT_TRUE(terminal.shows("recording ")) << terminal.shown();
  terminal.press("s");
  EXPECT_TRUE(terminal.shows("_1.mcap")) << terminal.shown();
  terminal.press("q");
  EXPECT_EQ(terminal.end(), 0);
  EXPECT_TRUE(terminal.is_a_shells()) << "the terminal is not as it was";
  std::size_t snapshots = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    if (entry.path().extension() == ".mcap") {
      ++snapshots;
      EXPECT_EQ(content(entry.path(), "grasp/report").size(), 1u);
    }
  EXPECT_EQ(snapshots, 1u);
}

TEST_F(Recording, TypesAreDescribedAsAskedFor) {
  auto detections = writer(dds::object_detection);
  ASSERT_TRUE(detections.write(detection(1, 1)));
  for (const auto& [schema, name] : {std::pair{"ros2msg", "prehend_v1/msg/ObjectDetection"},
                                     std::pair{"omgidl", "prehend::v1::ObjectDetection"}}) {
    const std::string path = std::string(schema) + ".mcap";
    auto process = record(path, {"object/detection", "--schema", schema});
    ASSERT_TRUE(eventually(20, [&] { return written(file(path), "object/detection") > 0; }));
    ASSERT_EQ(end(process), 0);
    const auto reader = recording::mcap::Reader::open(file(path));
    ASSERT_TRUE(reader);
    const auto& contents = reader->contents();
    ASSERT_EQ(contents.channels.size(), 1u);
    const auto& described = contents.schemas.at(contents.channels.begin()->second.schema_id);
    EXPECT_EQ(described.encoding, schema);
    EXPECT_EQ(described.name, name);
    EXPECT_NE(described.data.find("probability"), std::string::npos);
  }
}

TEST_F(Recording, WhatIsChosenIsRecordedAlsoWhenItComesLate) {
  auto detections = writer(dds::object_detection);
  auto states = writer(dds::object_state);
  auto process = record("some.mcap", {"object/*", "glove/*", "-x", "object/st?te"});
  meet(detections);
  auto frames = writer(dds::glove_frame);  // late
  auto reports = writer(dds::grasp_report);
  meet(frames);
  v1::GloveFrame frame;
  frame.glove("glove");
  v1::ObjectState state;
  state.body("body");
  v1::GraspReport report;
  report.hand("hand");
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(detections.write(detection(1, 1)));
    ASSERT_TRUE(frames.write(frame));
    ASSERT_TRUE(states.write(state));
    ASSERT_TRUE(reports.write(report));
  }
  ASSERT_TRUE(dds::succeeded(reports.raw().wait_for_acknowledgments({5, 0})));
  EXPECT_TRUE(eventually(20, [&] { return written(file("some.mcap"), "glove/frame") == 5; }));
  ASSERT_EQ(end(process), 0);
  EXPECT_EQ(counts(file("some.mcap")),
            (std::map<std::string, int>{{"glove/frame", 5}, {"object/detection", 5}}));
}

TEST_F(Recording, StartsPausesAndGoesOnByOrder) {
  auto process = record("orders.mcap", {"--paused", "hand/posture"});
  auto postures = writer(dds::hand_posture);
  meet(postures);
  v1::HandPosture posture;
  posture.glove("glove");
  const auto send = [&](std::uint64_t number) {
    posture.sequence_number(number);
    ASSERT_TRUE(postures.write(posture));
    ASSERT_TRUE(dds::succeeded(postures.raw().wait_for_acknowledgments({5, 0})));
  };
  const auto ordered = [&](const char* argument) {
    EXPECT_TRUE(order("recorder", argument).done()) << argument;
  };
  send(1);
  ordered("start");
  send(2);
  ordered("pause");
  send(3);
  ordered("resume");
  send(4);
  ordered("pause");
  ordered("stop");
  const auto exit = process.wait(seconds(10));
  ASSERT_TRUE(exit && exit->code == 0);
  std::vector<std::uint64_t> numbers;
  for (const Played& one : content(file("orders.mcap"), "hand/posture"))
    numbers.push_back(decoded(dds::hand_posture, one).sequence_number());
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{2, 4}));
}

// A recorder that stands still while more is sent than the socket holds loses samples of a best
// effort topic: each of them is either in the file or counted there.
TEST_F(Recording, WhatWasLostIsCountedInTheFile) {
  auto process = record("lossy.mcap", {"camera/image"});
  auto images = writer(dds::camera_image);
  meet(images);
  std::uint64_t sent = 0;
  const auto send = [&](int count) {
    for (int i = 0; i < count; ++i) ASSERT_TRUE(images.write(image(50'000, sent++)));
  };
  const auto written_out = [&] { return written(file("lossy.mcap"), "camera/image"); };
  send(3);
  ASSERT_TRUE(eventually(20, [&] { return written_out() == 3; }));
  process.signal(SIGSTOP);
  send(400);
  process.signal(SIGCONT);
  // Until the socket has been emptied and one that was sent after that has come.
  std::uint64_t before = 0;
  ASSERT_TRUE(eventually(20, [&] { return std::exchange(before, written_out()) > 3; }));
  ASSERT_TRUE(eventually(20, [&] {
    send(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return written_out() > before + 2;
  }));
  const std::uint64_t last = sent;
  ASSERT_TRUE(eventually(20, [&] {
    const auto images_there = content(file("lossy.mcap"), "camera/image");
    return decoded(dds::camera_image, images_there.back()).sequence_number() + 1 == last;
  }));
  ASSERT_EQ(end(process), 0);
  const auto document = info(file("lossy.mcap"));
  const std::uint64_t lost = document["lost"], recorded = document["messages"];
  EXPECT_GT(lost, 0u);
  EXPECT_EQ(recorded + lost, sent);
}

TEST_F(Recording, EndsOfInstancesAreKeptAsTheyWere) {
  auto process = record("ends.mcap", {"some/topic"});
  auto made = dds::RawWriter::create(
      *participant_,
      {.name = "some/topic", .type = "some::Type", .keyed = true, .qos = {.writer_depth = 0}});
  ASSERT_TRUE(made);
  ASSERT_TRUE(eventually(10, [&] {
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    made->raw().get_publication_matched_status(status);
    return status.current_count > 0;
  }));
  std::vector<std::pair<int, Kind>> changes{
      {1, Kind::data}, {2, Kind::data},         {1, Kind::unregistered}, {2, Kind::disposed},
      {1, Kind::data}, {2, Kind::unregistered}, {1, Kind::disposed}};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    dds::RawSample sample;
    sample.kind = changes[i].second;
    sample.instance[0] = static_cast<std::uint8_t>(changes[i].first);
    if (sample.kind == Kind::data) sample.payload = {0, 1, 0, 0, sample.instance[0], 2, 3, 4};
    ASSERT_TRUE(made->write(sample, from_ns(now_ns())));
  }
  ASSERT_TRUE(dds::succeeded(made->raw().wait_for_acknowledgments({5, 0})));
  ASSERT_EQ(end(process), 0);
  std::vector<std::pair<int, Kind>> kept;
  for (const Played& one : content(file("ends.mcap"), "some/topic"))
    kept.emplace_back(one.sample.instance[0], one.sample.kind);
  EXPECT_EQ(kept, changes);
}

// Cyclone DDS sends no keys beside its samples, and with the end of an instance its key fields: the
// keys are found in them. Of a key that is longer than 16 bytes (with its head) Fast DDS keeps
// nothing then: such an end is recorded without key.
TEST_F(Recording, InstancesOfWritersOfAnotherMakeAreKeptApart) {
  auto process = record("cyclone.mcap", {"object/detection", "camera/image"});
  auto peer = start_program("cyclone_writer", {std::to_string(domain_), name_});
  ASSERT_TRUE(eventually(20, [&] {
    return stage::last_lines(folder_ / "cyclone_writer.log", 1).find("written") !=
           std::string::npos;
  }));
  ASSERT_EQ(end(process), 0);
  using Life = std::vector<std::pair<Kind, std::uint64_t>>;
  const auto lives = [&](const auto& topic) {
    std::map<dds::Guid, Life> all;
    for (const Played& one : content(file("cyclone.mcap"), std::string(topic.name)))
      all[one.sample.instance].emplace_back(
          one.sample.kind,
          one.sample.kind == Kind::data ? decoded(topic, one).sequence_number() : 0);
    return all;
  };
  const Life ended{{Kind::data, 0}, {Kind::data, 2}, {Kind::data, 4}, {Kind::disposed, 0}};
  const Life living{{Kind::data, 1}, {Kind::data, 3}, {Kind::data, 5}};
  const auto detections = lives(dds::object_detection);
  EXPECT_EQ(detections, (std::map<dds::Guid, Life>{{dds::Guid{0, 0, 0, 4}, ended},
                                                   {dds::Guid{0, 0, 0, 7}, living}}));
  std::vector<Life> images;
  for (const auto& [instance, life] : lives(dds::camera_image))
    if (instance == dds::Guid{})
      EXPECT_EQ(life, (Life{{Kind::disposed, 0}}));
    else
      images.push_back(life);
  EXPECT_THAT(images, testing::UnorderedElementsAre(ended, living));
}

}  // namespace
}  // namespace prehend::integration
