// What a recorder decides about samples: files, their splits and heads, rings, losses. Time is a
// value here and files are small, so nothing waits.
#include "services/recorder/service/recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/recording/mcap/reader.hpp"
#include "services/recorder/core/topic_filter.hpp"
#include "services/recorder/service/tape.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder {
namespace {

using Kind = dds::RawSample::Kind;
using Numbers = std::vector<std::uint64_t>;

const Time start = from_ns(1'700'000'000'000'000'000);

struct Recording : ::testing::Test {
  prehend::testing::Scratch folder;
  Heading heading;
  Source state{{.name = "world/state", .type = "State", .qos = {.transient_local = true}}, "rig"};
  Source frame{{.name = "world/frame", .type = "Frame", .qos = {}}, "rig"};
  std::uint64_t count = 0;

  RecorderOptions options() {
    return {.file = folder / "a.mcap",
            .keep_free = 0,
            .compression = recording::mcap::Compression::none};
  }
  Recorder recorder(const RecorderOptions& options) {
    auto made = Recorder::create(options, heading, start);
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  /// Numbers of samples count over all topics, from 1.
  dds::RawSample sample(double at, std::uint8_t instance = 1, Kind kind = Kind::data,
                        std::size_t bytes = 100) {
    dds::RawSample made;
    made.kind = kind;
    made.instance[15] = instance;
    made.writer[0] = 9;
    made.sequence = ++count;
    made.sent = made.received = start + seconds(at);
    if (kind == Kind::data) made.payload.assign(bytes, 1);
    return made;
  }
  Numbers numbers(const std::string& name, const std::string& topic) {
    auto tape = Tape::open({folder / name}, [&](const std::string& each) { return each == topic; });
    Numbers all;
    if (!tape) return all;
    while (const auto one = tape->next()) all.push_back(one->sample.sequence);
    EXPECT_TRUE(tape->damage().empty() || !tape->file(0).contents().closed);
    return all;
  }
  static Expected<std::filesystem::path> snapshot(Recorder& recorder, Time now) {
    const auto taken = recorder.snapshot(now);
    if (!taken) return tl::unexpected(taken.error());
    const auto written = taken->write();
    if (!written) return tl::unexpected(written.error());
    recorder.add(*written);
    return written->path;
  }
  std::vector<std::string> files() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
      names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }
  static std::string lost_in(const std::filesystem::path& file, const std::string& topic) {
    const auto reader = recording::mcap::Reader::open(file);
    if (!reader) return "";
    std::string last;
    for (const auto& index : reader->contents().metadata)
      if (index.name == recording::losses_record)
        last = recording::mcap::find(reader->metadata(index)->metadata, topic);
    return last;
  }
};

TEST_F(Recording, SplitsBySizeAndKeepsTheNewestFiles) {
  auto chosen = options();
  chosen.split_bytes = 5'000;
  chosen.keep_files = 2;
  auto recorder = this->recorder(chosen);
  for (int i = 0; i < 200; ++i) recorder.take(frame, sample(0.01 * i));
  ASSERT_TRUE(recorder.close());
  ASSERT_EQ(files().size(), 2u);
  EXPECT_EQ(recorder.messages(), 200u);
  Numbers kept;
  for (const auto& path : recorder.files()) {
    const Numbers part = numbers(path.filename(), "world/frame");
    EXPECT_LT(std::filesystem::file_size(path), 9'000u);
    kept.insert(kept.end(), part.begin(), part.end());
  }
  ASSERT_GT(kept.size(), 10u);
  EXPECT_EQ(kept.back(), 200u);
  for (std::size_t i = 1; i < kept.size(); ++i) EXPECT_EQ(kept[i], kept[i - 1] + 1);
}

TEST_F(Recording, EveryFileBeginsWithTheLastStateOfLivingInstances) {
  auto chosen = options();
  chosen.split_time = seconds(1);
  auto recorder = this->recorder(chosen);
  recorder.take(state, sample(0.0, 1));                  // 1, overtaken by 3
  recorder.take(state, sample(0.1, 2));                  // 2
  recorder.take(state, sample(0.2, 1));                  // 3
  recorder.take(state, sample(0.3, 3));                  // 4, ended by 5
  recorder.take(state, sample(0.4, 3, Kind::disposed));  // 5
  recorder.take(frame, sample(1.1));                     // 6
  recorder.take(state, sample(2.2, 2));                  // 7, itself the cause of a split
  ASSERT_TRUE(recorder.close());
  EXPECT_EQ(files(), (std::vector<std::string>{"a.mcap", "a_1.mcap", "a_2.mcap"}));
  EXPECT_EQ(numbers("a.mcap", "world/state"), (Numbers{1, 2, 3, 4, 5}));
  Numbers head = numbers("a_1.mcap", "world/state");
  std::ranges::sort(head);
  EXPECT_EQ(head, (Numbers{2, 3}));
  EXPECT_EQ(numbers("a_1.mcap", "world/frame"), (Numbers{6}));
  head = numbers("a_2.mcap", "world/state");
  std::ranges::sort(head);
  EXPECT_EQ(head, (Numbers{3, 7}));
  EXPECT_EQ(recorder.messages(), 7u);
}

TEST_F(Recording, APauseLeavesOutWhatComesAndEndsWithTheStateOfThen) {
  auto recorder = this->recorder(options());
  recorder.take(state, sample(0, 1));
  recorder.take(frame, sample(0.1));
  recorder.pause(start + seconds(0.15));
  EXPECT_TRUE(recorder.paused());
  recorder.take(frame, sample(0.14));  // 3: came before, but waited in a queue
  recorder.take(state, sample(0.2, 1));
  recorder.take(frame, sample(0.3));
  recorder.resume(start + seconds(0.4));
  EXPECT_FALSE(recorder.paused());
  recorder.take(frame, sample(0.39));     // 6: came in the pause
  recorder.take(state, sample(0.39, 1));  // 7: the same, but a late reader would be given it
  recorder.take(frame, sample(0.5));
  ASSERT_TRUE(recorder.close());
  EXPECT_EQ(numbers("a.mcap", "world/frame"), (Numbers{2, 3, 8}));
  EXPECT_EQ(numbers("a.mcap", "world/state"), (Numbers{1, 4, 7}));
}

TEST_F(Recording, ASnapshotHoldsTheLastSecondsAndTheStateBefore) {
  auto chosen = options();
  chosen.snapshot = seconds(2);
  auto recorder = this->recorder(chosen);
  recorder.take(state, sample(0, 1));
  for (int i = 0; i < 50; ++i) recorder.take(frame, sample(0.1 * (i + 1)));
  recorder.set_lost("world/frame", 3);
  EXPECT_TRUE(files().empty());
  const auto first = snapshot(recorder, start + seconds(5));
  ASSERT_TRUE(first) << first.error().message();
  // From 3.0 s to 5.0 s, both included: the ring holds what is no older than 2 s.
  const Numbers kept = numbers(first->filename(), "world/frame");
  EXPECT_EQ(kept.size(), 21u);
  EXPECT_EQ(kept.back(), 51u);
  EXPECT_EQ(numbers(first->filename(), "world/state"), (Numbers{1}));
  EXPECT_EQ(lost_in(*first, "world/frame"), "3");
  // Again, with what has come since.
  recorder.take(frame, sample(5.1));
  const auto second = snapshot(recorder, start + seconds(6));
  ASSERT_TRUE(second);
  EXPECT_NE(*first, *second);
  EXPECT_EQ(numbers(second->filename(), "world/frame").back(), 52u);
}

TEST_F(Recording, ARingStaysWithinItsMemoryAndRestsInAPause) {
  auto chosen = options();
  chosen.snapshot = seconds(1000);
  chosen.snapshot_bytes = 50'000;
  auto recorder = this->recorder(chosen);
  for (int i = 0; i < 100; ++i) {
    recorder.take(frame, sample(0.1 * i, 1, Kind::data, 1000));
    EXPECT_LE(recorder.ring_bytes(), 50'000u);
  }
  EXPECT_GT(recorder.ring_bytes(), 45'000u);
  recorder.pause(start + seconds(10.5));
  recorder.take(frame, sample(11));
  recorder.take(state, sample(12));
  const auto written = snapshot(recorder, start + seconds(13));
  ASSERT_TRUE(written);
  EXPECT_EQ(numbers(written->filename(), "world/frame").back(), 100u);
  EXPECT_EQ(numbers(written->filename(), "world/state"), (Numbers{102}));
}

// The disk may be slow: what comes while a snapshot is written goes on into the ring.
TEST_F(Recording, ASnapshotIsWrittenWithoutTheRecorder) {
  auto chosen = options();
  chosen.snapshot = seconds(1);
  auto recorder = this->recorder(chosen);
  recorder.take(state, sample(0, 1));
  recorder.take(frame, sample(0.1));
  const auto taken = recorder.snapshot(start + seconds(0.2));
  ASSERT_TRUE(taken);
  recorder.take(state, sample(0.3, 1, Kind::disposed));
  for (int i = 0; i < 50; ++i) recorder.take(frame, sample(1 + 0.1 * i));
  const auto written = taken->write();
  ASSERT_TRUE(written) << written.error().message();
  EXPECT_EQ(numbers(written->path.filename(), "world/state"), (Numbers{1}));
  EXPECT_EQ(numbers(written->path.filename(), "world/frame"), (Numbers{2}));
  const auto again = taken->write();
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().message(),
            written->path.string() + ": is there already (choose another name or remove it)");
  recorder.add(*written);
  EXPECT_EQ(recorder.messages(), 2u);
  EXPECT_EQ(recorder.files().size(), 1u);
}

TEST_F(Recording, ASnapshotLeavesTheDiskItsReserve) {
  auto chosen = options();
  chosen.snapshot = seconds(1);
  chosen.keep_free = std::uint64_t{1} << 60;
  auto recorder = this->recorder(chosen);
  recorder.take(frame, sample(0));
  const auto refused = snapshot(recorder, start + seconds(1));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("free on the disk"), std::string::npos);
  EXPECT_TRUE(files().empty());
  // The reserve counts with what would be written.
  const auto room = std::filesystem::space(folder / "").available;
  EXPECT_FALSE(check_space(folder / "a.mcap", room + 1'000'000'000, 0));
  EXPECT_TRUE(check_space(folder / "a.mcap", 1, 0));
  // It goes on: nothing has failed but this snapshot.
  EXPECT_FALSE(recorder.error());
}

TEST_F(Recording, LossesStandInTheFileAndAddUp) {
  auto recorder = this->recorder(options());
  recorder.take(frame, sample(0));
  recorder.set_lost("world/frame", 5);
  recorder.set_lost("world/state", 2);
  recorder.tick(start + seconds(1));
  recorder.set_lost("world/frame", 7);
  ASSERT_TRUE(recorder.close());
  EXPECT_EQ(recorder.lost(), 9u);
  EXPECT_EQ(lost_in(folder / "a.mcap", "world/frame"), "7");
  EXPECT_EQ(lost_in(folder / "a.mcap", "world/state"), "2");
}

// A recorder that is killed leaves all but the last second: what tick() has written out counts.
TEST_F(Recording, WritesOutTwiceASecondAndNotMoreOften) {
  auto recorder = this->recorder(options());
  const auto size = [&] { return std::filesystem::file_size(folder / "a.mcap"); };
  const auto empty = size();
  recorder.tick(start);
  recorder.take(frame, sample(0.01));
  recorder.tick(start + seconds(0.1));
  EXPECT_EQ(size(), empty);
  recorder.tick(start + seconds(0.5));
  EXPECT_GT(size(), empty);
  EXPECT_EQ(numbers("a.mcap", "world/frame"), (Numbers{1}));
}

TEST_F(Recording, EndsWhenLessIsFreeThanItMayLeave) {
  auto chosen = options();
  chosen.keep_free = std::uint64_t{1} << 60;
  auto recorder = this->recorder(chosen);
  recorder.take(frame, sample(0));
  recorder.tick(start + seconds(1));
  ASSERT_TRUE(recorder.error());
  EXPECT_NE(recorder.error()->what.find("free on the disk"), std::string::npos);
  recorder.take(frame, sample(1));  // nothing happens
  EXPECT_FALSE(recorder.close());
  EXPECT_EQ(numbers("a.mcap", "world/frame"), (Numbers{1}));
  EXPECT_TRUE(recording::mcap::Reader::open(folder / "a.mcap")->contents().closed);
}

TEST_F(Recording, NothingThatIsThereIsWrittenOver) {
  prehend::testing::write_bytes(folder / "a.mcap", std::string("mine"));
  const auto made = Recorder::create(options(), heading, start);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message().find("is there already"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(folder / "a.mcap"), 4u);
}

// The index of a file is kept in memory until its end: a file with a long one gets a successor,
// however small it is. Here every message is a chunk of its own with an entry of about 100 bytes.
TEST_F(Recording, TheIndexOfAFileIsBounded) {
  auto recorder = this->recorder(options());
  const int messages = 250'000;
  for (int i = 0; i < messages; ++i) {
    recorder.take(frame, sample(0.5 * i, 1, Kind::data, 4));
    recorder.tick(start + seconds(0.5 * i));
    if (files().size() > 1 && i % 1000 == 0) break;
  }
  ASSERT_TRUE(recorder.close());
  EXPECT_GT(recorder.files().size(), 1u);
}

TEST(TopicFilter, PatternsAreThoseOfAShellAndExclusionGoesFirst) {
  EXPECT_TRUE(TopicFilter{}.wants("any/thing"));
  const TopicFilter some{{"robot/*", "scene/stat?"}, {"robot/state"}};
  EXPECT_TRUE(some.wants("robot/command"));
  EXPECT_TRUE(some.wants("robot/arm/left"));
  EXPECT_TRUE(some.wants("scene/state"));
  EXPECT_FALSE(some.wants("robot/state"));
  EXPECT_FALSE(some.wants("scene/status"));
  EXPECT_FALSE(some.wants("glove/frame"));
  EXPECT_FALSE((TopicFilter{{}, {"*/image"}}).wants("camera/image"));
}

}  // namespace
}  // namespace prehend::recorder
