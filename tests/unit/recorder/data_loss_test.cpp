// What a tool does not write is an error, whatever it is of: a damaged recording, one whose summary
// lies, topics that share a name, messages that nobody can decode, a full disk.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "common/recording/mcap/record_stream.hpp"
#include "tests/support/foreign/foreign.hpp"
#include "tests/unit/recorder/recording_command.hpp"

namespace prehend::recorder {
namespace {

// Guards recover, which exited with 0 whatever was lost.
TEST_F(RecordingCommand, RecoverSaysByItsExitCodeWhetherAnythingIsLost) {
  make_unfinished("whole.mcap");
  const Answer whole = run("prehend recording recover whole.mcap -o a.mcap --json");
  EXPECT_EQ(whole.code, 0) << whole.complaint;
  EXPECT_THAT(whole.complaint, HasSubstr("no end"));
  EXPECT_TRUE(Json::parse(whole.output)["damage"].empty());
  EXPECT_EQ(content("a.mcap").size(), 19u);
  // Zeros, as a disk leaves them that has lost its power.
  auto bytes = testing::file_bytes(scratch_ / "whole.mcap");
  bytes.resize(bytes.size() + 5000);
  testing::write_bytes(scratch_ / "zeros.mcap", bytes);
  const Answer zeros = run("prehend recording recover zeros.mcap -o b.mcap");
  EXPECT_EQ(zeros.code, 1);
  EXPECT_THAT(zeros.complaint, HasSubstr("zeros"));
  EXPECT_EQ(content("b.mcap").size(), 19u);
  // Another recording behind the end.
  make("one.mcap");
  ASSERT_EQ(run("cat one.mcap one.mcap > two.mcap").code, 0);
  for (const char* command : {"recover", "cut --from 0", "merge"}) {
    const Answer two = run(fmt::format("prehend recording {} two.mcap -o c.mcap", command));
    EXPECT_EQ(two.code, 1) << command;
    EXPECT_THAT(two.complaint, HasSubstr("another recording begins")) << command;
    EXPECT_EQ(content("c.mcap").size(), 19u) << command;
  }
  EXPECT_EQ(run("prehend recording export two.mcap -o tables").code, 1);
  // Anything else behind it.
  ASSERT_EQ(run("(cat one.mcap; echo more) > three.mcap").code, 0);
  const Answer three = run("prehend recording recover three.mcap -o d.mcap");
  EXPECT_EQ(three.code, 1);
  EXPECT_THAT(three.complaint, HasSubstr("5 bytes after"));
}

/// A recording of others: channels as given, each with messages at these times; statistics and the
/// times of chunks as `lie` makes them.
struct Foreign {
  std::string topic, type, data, encoding = "cdr";
  std::vector<std::uint64_t> times;
};

void write_foreign(const std::filesystem::path& path, const std::vector<Foreign>& channels,
                   const std::function<void(recording::mcap::Record&)>& lie = {}) {
  using namespace recording::mcap;
  {
    auto writer = Writer::create(path, {.compression = Compression::none}).value();
    for (const Foreign& each : channels) {
      const auto schema = writer.add_schema(each.type, "ros2msg", each.data).value();
      const auto channel = writer.add_channel(schema, each.topic, each.encoding).value();
      std::uint32_t sequence = 0;
      const Bytes payload{0, 1, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 6, 0, 0, 0};
      for (const std::uint64_t time : each.times)
        ASSERT_TRUE(writer.write(Message{channel, ++sequence, time, time, payload}));
    }
    ASSERT_TRUE(writer.close());
  }
  if (!lie) return;
  // Written again record by record, without check sums.
  const Bytes bytes = testing::file_bytes(path);
  Bytes changed(magic.begin(), magic.end());
  ChunkRecords records(View(bytes).subspan(magic.size(), bytes.size() - 2 * magic.size()));
  for (auto raw = records.next().value(); raw; raw = records.next().value()) {
    auto record = parse(raw->opcode, raw->content).value();
    lie(record);
    std::visit(
        [&](const auto& each) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(each)>, Unknown>)
            append_record(changed, each);
        },
        record);
  }
  append(changed, View(magic));
  testing::write_bytes(path, changed);
}

// Guards cut, info and replay, which believed the summary and gave nothing.
TEST_F(RecordingCommand, DataDecideNotTheSummary) {
  using namespace recording::mcap;
  std::vector<std::uint64_t> times;
  for (std::uint64_t i = 0; i < 20; ++i) times.push_back(begin_ns + i * 10'000'000);
  const std::vector<Foreign> channels{{"/a", "x/msg/A", "int32 a\n", "cdr", times}};
  const std::function<void(Record&)> lies[] = {
      [](Record& record) {
        if (auto* said = std::get_if<Statistics>(&record)) said->message_start_time = 0;
        if (auto* footer = std::get_if<Footer>(&record)) footer->summary_crc = 0;
      },
      [](Record& record) {
        if (auto* said = std::get_if<Statistics>(&record)) {
          said->message_start_time = said->message_end_time = 7;
          said->message_count = 1000;
        }
        if (auto* footer = std::get_if<Footer>(&record)) footer->summary_crc = 0;
      },
      [](Record& record) {  // of the chunk, in both places
        if (auto* chunk = std::get_if<Chunk>(&record))
          chunk->message_start_time = chunk->message_end_time = 0;
        if (auto* index = std::get_if<ChunkIndex>(&record))
          index->message_start_time = index->message_end_time = 0;
        if (auto* footer = std::get_if<Footer>(&record)) footer->summary_crc = 0;
      }};
  for (const auto& lie : lies) {
    write_foreign(scratch_ / "a.mcap", channels, lie);
    const Answer info = run("prehend recording info a.mcap --json");
    EXPECT_EQ(info.code, 0);
    const Json document = Json::parse(info.output);
    EXPECT_EQ(document["messages"], 20);
    EXPECT_NEAR(document["duration_s"], 0.19, 1e-9);
    EXPECT_EQ(document["start_ns"], begin_ns);
    EXPECT_EQ(document["topics"][0]["count"], 20);
    EXPECT_FALSE(document["remarks"].empty());
    EXPECT_TRUE(document["damage"].empty());
    const Answer cut = run("prehend recording cut a.mcap --from 0.045 --until 0.095 -o b.mcap");
    EXPECT_EQ(cut.code, 0) << cut.complaint;
    EXPECT_EQ(cut.output, "b.mcap: 5 messages\n");
    EXPECT_EQ(run("prehend recording verify b.mcap").code, 0);
  }
}

TEST_F(RecordingCommand, StampsInAnotherUnitAreSaid) {
  for (const auto& [unit, word] : {std::pair<std::uint64_t, std::string>{1, "seconds"},
                                   {1'000, "milliseconds"},
                                   {1'000'000, "microseconds"}}) {
    std::vector<std::uint64_t> times;
    for (std::uint64_t i = 0; i < 20; ++i)
      times.push_back(1'760'000'000 * unit + i * unit / 50 + (unit == 1 ? i : 0));
    write_foreign(scratch_ / "a.mcap", {{"/a", "x/msg/A", "int32 a\n", "cdr", times}});
    EXPECT_THAT(run("prehend recording info a.mcap").complaint, HasSubstr("look like " + word))
        << word;
  }
  // A simulation that begins at 0, or a second later, is none of these.
  for (const std::uint64_t start : {0ull, 1'760'000'000ull}) {
    std::vector<std::uint64_t> times;
    for (std::uint64_t i = 0; i < 20; ++i) times.push_back(start + i * 10'000'000);
    write_foreign(scratch_ / "a.mcap", {{"/a", "x/msg/A", "int32 a\n", "cdr", times}});
    EXPECT_EQ(run("prehend recording info a.mcap").complaint, "");
  }
}

// Guards tables: two topics went to one file, and a topic with two types into one table.
TEST_F(RecordingCommand, EachTopicAndTypeHasAFileOfItsOwn) {
  const std::string long_name = "/" + std::string(300, 'x');
  const std::vector<std::uint64_t> times{10, 20};
  write_foreign(scratch_ / "a.mcap", {{"/a/b", "x/msg/A", "int32 a\n", "cdr", times},
                                      {"/a-b", "x/msg/A", "int32 a\n", "cdr", times},
                                      {"a/b", "x/msg/A", "int32 a\n", "cdr", times},
                                      {"/A/b", "x/msg/A", "int32 a\n", "cdr", times},
                                      {"/two", "x/msg/A", "int32 a\n", "cdr", times},
                                      {"/two", "x/msg/B", "int32 a\nint32 b\n", "cdr", times},
                                      {"/../up", "x/msg/A", "int32 a\n", "cdr", times},
                                      {"/one", "x/msg/A", "int32 a\n", "cdr", times},
                                      {long_name, "x/msg/A", "int32 a\n", "cdr", times}});
  const Answer answer = run("prehend recording export a.mcap -o tables");
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scratch_ / "tables")) {
    ++files;
    std::ifstream table(entry.path());
    std::string heading, row;
    std::getline(table, heading);
    int rows = 0;
    for (; std::getline(table, row); ++rows)
      EXPECT_EQ(std::ranges::count(row, ','), std::ranges::count(heading, ',')) << entry.path();
    EXPECT_EQ(rows, 2) << entry.path();
  }
  EXPECT_EQ(files, 9u);
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "tables" / "one.csv"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "up.csv"));
  EXPECT_EQ(run("prehend recording export a.mcap --topic /two").code, 2);  // two tables
  EXPECT_EQ(run("prehend recording export a.mcap --topic /one").code, 0);
}

// Guards exports that wrote nothing, or not all, and ended with 0.
TEST_F(RecordingCommand, WhatIsNotExportedIsNamedByItsEncoding) {
  write_foreign(scratch_ / "a.mcap", {{"/json", "x", "{}", "json", {10, 20}},
                                      {"/good", "x/msg/A", "int32 a\n", "cdr", {10}}});
  const Answer some = run("prehend recording export a.mcap -o some");
  EXPECT_EQ(some.code, 1);
  EXPECT_THAT(some.complaint, HasSubstr("/json: 2 messages are left out: "));
  EXPECT_THAT(some.complaint, HasSubstr("encoding «json»"));
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "some" / "good.csv"));
  const Answer none = run("prehend recording export a.mcap --topic /json -o none");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.complaint, HasSubstr("no message could be exported"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "none"));  // no folder that stays empty
  test::write_recording(scratch_ / "theirs.mcap", test::Stack::json);
  const Answer theirs = run("prehend recording export theirs.mcap --topic /run");
  EXPECT_EQ(theirs.code, 1);
  EXPECT_THAT(theirs.complaint, HasSubstr("/run: 4 messages are left out: encoding «json» tells no "
                                          "columns; --format jsonl takes it"));
}

TEST_F(RecordingCommand, ATableWhoseFileCannotBeWrittenIsNamed) {
  make("a.mcap");
  std::filesystem::create_directories(scratch_ / "tables/robot-command.csv");
  const Answer answer = run("prehend recording export a.mcap -o tables");
  EXPECT_EQ(answer.code, 3);
  EXPECT_THAT(answer.complaint,
              HasSubstr("tables/robot-command.csv: cannot be written (is there room, and"));
}

// Guards full disks behind standard output: half a document was an answer.
TEST_F(RecordingCommand, AFullStandardOutputIsAnError) {
  make("a.mcap");
  for (const char* command :
       {"recording info a.mcap", "recording info a.mcap --json", "recording records a.mcap",
        "recording export a.mcap --topic robot/command", "recording verify a.mcap --json",
        "recording diff a.mcap a.mcap --json", "recording cut a.mcap -o b.mcap --json",
        "recording --help", "scene --seed 1", "--help", "--version", "doctor --help"}) {
    const Answer answer = run(fmt::format("prehend {} > /dev/full", command));
    EXPECT_EQ(answer.code, 3) << command;
    EXPECT_THAT(answer.complaint, HasSubstr("standard output")) << command;
  }
}

}  // namespace
}  // namespace prehend::recorder
