// `prehend recording` as a user calls it: exit codes, JSON alone on standard output, first
// differences that can be read, and the examples of services/recorder/README.md line by line.
#include "tests/unit/recorder/recording_command.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

namespace prehend::recorder {
namespace {

TEST_F(RecordingCommand, InfoTellsWhatIsThere) {
  make("a.mcap");
  const Answer answer = run("prehend recording info a.mcap --json");
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  const Json document = Json::parse(answer.output);
  EXPECT_NEAR(document["duration_s"], 0.92, 1e-9);
  EXPECT_EQ(document["lost"], 3);
  EXPECT_EQ(document["closed"], true);
  ASSERT_EQ(document["topics"].size(), 2u);
  EXPECT_EQ(document["topics"][0]["name"], "object/detection");
  EXPECT_EQ(document["topics"][0]["type"], "prehend::v1::ObjectDetection");
  EXPECT_EQ(document["topics"][0]["count"], 8);
  EXPECT_EQ(document["topics"][0]["ends"], 1);
  EXPECT_EQ(document["topics"][1]["count"], 10);
  EXPECT_EQ(document["attachments"], Json({"scene.toml"}));
  const Answer text = run("prehend recording info a.mcap");
  EXPECT_THAT(text.output, HasSubstr("19 messages in 0.920 s, 3 lost"));
  make_killed("b.mcap");
  const Answer killed = run("prehend recording info b.mcap --json");
  EXPECT_EQ(killed.code, 0);
  EXPECT_EQ(Json::parse(killed.output)["closed"], false);
  EXPECT_THAT(killed.complaint, HasSubstr("recover"));
}

// A part must say what is where, although it was said before the part began.
TEST_F(RecordingCommand, CutBeginsWithWhatStands) {
  make("a.mcap");
  ASSERT_EQ(run("prehend recording cut a.mcap --from 0.45 --until 0.7 -o b.mcap").code, 0);
  const auto told = [&](const std::string& name) {
    std::vector<std::string> lines;
    for (const Played& one : content(name))
      lines.push_back(fmt::format("{} {} {}{}", one.stream->topic.name, one.sample.sequence,
                                  (to_ns(one.log_time) - begin_ns) / 1'000'000,
                                  one.sample.kind == RawSample::Kind::data ? "" : " gone"));
    return lines;
  };
  // As in a recorder's parts: at the log time of the beginning.
  EXPECT_THAT(told("b.mcap"), ElementsAre("object/detection 4 450", "object/detection 5 450",
                                          "object/detection 6 500", "robot/command 6 520",
                                          "object/detection 7 550 gone", "object/detection 7 600",
                                          "robot/command 7 620"));
  EXPECT_EQ(to_ns(content("b.mcap")[0].sample.sent), begin_ns + 300'000'000);
  // Who is gone by then does not stand, and other topics only if they are wanted.
  ASSERT_EQ(run("prehend recording cut a.mcap --from 0.75 --topic 'object/*' -o c.mcap").code, 0);
  EXPECT_THAT(told("c.mcap"), ElementsAre("object/detection 7 750", "object/detection 9 800"));
  ASSERT_EQ(run("prehend recording cut a.mcap --from 0.75 --topic 'robot/*' -o d.mcap").code, 0);
  EXPECT_THAT(told("d.mcap"), ElementsAre("robot/command 9 820", "robot/command 10 920"));
  for (const char* name : {"b.mcap", "c.mcap", "d.mcap"})
    EXPECT_EQ(run(std::string("prehend recording verify ") + name).code, 0);
}

// A part of nothing was written, and two recordings were the same in a topic that neither has.
TEST_F(RecordingCommand, NothingThatIsAskedForIsTold) {
  make("a.mcap");
  for (const auto& [command, code, what] :
       {std::tuple("cut a.mcap --topic 'hnad/*' -o b.mcap", 1, "no such topic as hnad/*"),
        std::tuple("cut a.mcap --from 5 --until 2 -o b.mcap", 2, "ends before it begins"),
        std::tuple("cut a.mcap --from nan -o b.mcap", 2, "--from: nan is no finite number"),
        std::tuple("diff a.mcap a.mcap --topic hnad", 1, "no such topic as hnad"),
        std::tuple("export a.mcap --topic hnad", 1, "no such topic as hnad")}) {
    const Answer answer = run(std::string("prehend recording ") + command);
    EXPECT_EQ(answer.code, code) << command;
    EXPECT_THAT(answer.complaint, HasSubstr(what)) << command;
    EXPECT_EQ(answer.output, "") << command;
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "b.mcap")) << command;
  }
  EXPECT_EQ(run("prehend recording diff a.mcap a.mcap --topic 'robot/*'").code, 0);
  const Answer late = run("prehend recording cut a.mcap --from 100 -o b.mcap");
  EXPECT_EQ(late.code, 0);
  EXPECT_THAT(late.complaint, HasSubstr("ends after 0.920 s, before --from"));
}

TEST_F(RecordingCommand, CutAndMergeTellTheirDamageAndNeverReplaceTheirSource) {
  make("a.mcap");
  make_killed("b.mcap");
  const Answer merged = run("prehend recording merge b.mcap a.mcap -o all.mcap --json");
  EXPECT_EQ(merged.code, 1);
  const Json document = Json::parse(merged.output);
  EXPECT_EQ(document["file"], "all.mcap");
  EXPECT_FALSE(document["damage"].empty());
  Time last{};
  for (const Played& one : content("all.mcap")) {
    EXPECT_GE(one.log_time, last);
    last = one.log_time;
  }
  EXPECT_GT(content("all.mcap").size(), content("a.mcap").size());
  EXPECT_EQ(run("prehend recording cut a.mcap --from 0.1 -o a.mcap").code, 3);
  EXPECT_EQ(run("prehend recording verify a.mcap").code, 0);
  EXPECT_EQ(run("prehend recording cut a.mcap --from x -o c.mcap").code, 2);
  EXPECT_EQ(run("prehend recording merge missing.mcap -o c.mcap").code, 3);
}

TEST_F(RecordingCommand, VerifyAndRecover) {
  make("a.mcap");
  const Answer sound = run("prehend recording verify a.mcap --json");
  EXPECT_EQ(sound.code, 0);
  EXPECT_EQ(Json::parse(sound.output), (Json{{"sound", true}, {"findings", Json::array()}}));
  auto bytes = testing::file_bytes(scratch_ / "a.mcap");
  bytes[bytes.size() / 2] ^= 16;
  testing::write_bytes(scratch_ / "b.mcap", bytes);
  const Answer damaged = run("prehend recording verify b.mcap --json");
  EXPECT_EQ(damaged.code, 1);
  EXPECT_THAT(Json::parse(damaged.output)["findings"][0]["where"].get<std::string>(),
              HasSubstr("b.mcap at byte"));
  make_killed("c.mcap");
  EXPECT_EQ(run("prehend recording verify c.mcap").code, 1);
  // All but the record that was being written: part of it is lost.
  ASSERT_EQ(run("prehend recording recover c.mcap -o d.mcap").code, 1);
  EXPECT_EQ(run("prehend recording verify d.mcap").code, 0);
  EXPECT_EQ(content("d.mcap").size(), content("c.mcap").size());
}

TEST_F(RecordingCommand, ForeignEmptyAndFutureFilesAreRefusedWithAReason) {
  make("a.mcap");
  auto future = testing::file_bytes(scratch_ / "a.mcap");
  future[5] = '1';  // the version in the first bytes
  testing::write_bytes(scratch_ / "future.mcap", future);
  testing::write_bytes(scratch_ / "foreign.mcap", std::string("\x89PNG\r\n and so on, for long"));
  testing::write_bytes(scratch_ / "empty.mcap", std::string());
  std::filesystem::create_directory(scratch_ / "folder.mcap");
  for (const char* command : {"info", "verify", "export", "cut -o x.mcap", "merge -o x.mcap",
                              "recover -o x.mcap", "diff a.mcap", "records"})
    for (const auto& [file, reason] :
         {std::pair("future.mcap", "another major version"),
          std::pair("foreign.mcap", "not an MCAP"), std::pair("empty.mcap", "too short"),
          std::pair("folder.mcap", ""), std::pair("missing.mcap", "")}) {
      const Answer answer = run(fmt::format("prehend recording {} {}", command, file));
      EXPECT_TRUE(answer.code == 1 || answer.code == 3) << command << file << answer.code;
      EXPECT_THAT(answer.complaint, HasSubstr(file)) << command;
      if (std::string(command) != "records") {
        EXPECT_THAT(answer.complaint, HasSubstr(reason)) << command;
        EXPECT_EQ(answer.output, "") << command;
      }
      EXPECT_FALSE(std::filesystem::exists(scratch_ / "x.mcap")) << command << file;
    }
}

TEST_F(RecordingCommand, ExportsTablesAndLines) {
  make("a.mcap");
  const Answer table = run("prehend recording export a.mcap --topic robot/command");
  ASSERT_EQ(table.code, 0) << table.complaint;
  std::istringstream lines(table.output);
  std::string heading, first, line;
  std::getline(lines, heading);
  std::getline(lines, first);
  EXPECT_THAT(heading, HasSubstr("log_time_ns,publish_time_ns,sequence,hand,sequence_number,"));
  EXPECT_THAT(heading, HasSubstr("X_WB.position.x,X_WB.position.y,"));
  EXPECT_THAT(first, HasSubstr("1700000000020000000,1700000000020000000,1,hand,"));
  EXPECT_THAT(first, HasSubstr(",\"[0.0,-1.0]\","));
  EXPECT_EQ(std::count(table.output.begin(), table.output.end(), '\n'), 11);

  const Answer json = run("prehend recording export a.mcap --format jsonl --topic 'object/*'");
  ASSERT_EQ(json.code, 0);
  std::istringstream documents(json.output);
  int count = 0;
  for (; std::getline(documents, line); ++count) {
    const Json document = Json::parse(line);
    EXPECT_EQ(document["topic"], "object/detection");
    EXPECT_EQ(document["message"]["name"], "Cup, \"large\"");
    EXPECT_EQ(document["message"]["track"], 1 + (document["sequence"].get<int>() - 1) % 2);
  }
  EXPECT_EQ(count, 8);

  EXPECT_EQ(run("prehend recording export a.mcap").code, 2);  // two topics, one table
  EXPECT_EQ(run("prehend recording export a.mcap --topic nobody").code, 1);
  ASSERT_EQ(run("prehend recording export a.mcap -o tables").code, 0);
  EXPECT_EQ(run("cat tables/robot-command.csv").output, table.output);
  // Quoted as CSV wants it.
  EXPECT_THAT(run("cat tables/object-detection.csv").output, HasSubstr("\"Cup, \"\"large\"\"\""));
}

TEST_F(RecordingCommand, DiffNamesTheFirstDifferences) {
  make("a.mcap");
  make("same.mcap");
  make("other.mcap", {.weight = 0.25});
  const Answer same = run("prehend recording diff a.mcap same.mcap --json");
  EXPECT_EQ(same.code, 0) << same.output;
  EXPECT_EQ(Json::parse(same.output)["verdict"], "same");
  const Answer text = run("prehend recording diff a.mcap other.mcap");
  EXPECT_EQ(text.code, 1);
  EXPECT_THAT(text.output, HasSubstr("robot/command                  10 compared, 1 different\n"
                                     "    origin 1700000000.600000 s, hand \"hand\": weight: "
                                     "expected 0.5, got 0.75 (tolerance 1e-06)\n"));
  const Json document = Json::parse(run("prehend recording diff a.mcap other.mcap --json").output);
  EXPECT_EQ(document["verdict"], "different");
  EXPECT_EQ(document["topics"][0]["different"], 0);
  EXPECT_EQ(document["topics"][1]["different"], 1);
  EXPECT_THAT(document["topics"][1]["first_difference"].get<std::string>(), HasSubstr("weight"));
  EXPECT_EQ(run("prehend recording diff a.mcap other.mcap --topic 'object/*'").code, 0);
}

TEST_F(RecordingCommand, DiffTakesAnotherTable) {
  make("a.mcap");
  make("other.mcap", {.weight = 0.25});
  testing::write_bytes(scratch_ / "wide.toml", std::string("[HandCommand]\nweight = 0.3\n"));
  testing::write_bytes(scratch_ / "wrong.toml", std::string("[HandCommand]\nweight = -1\n"));
  const std::string diff = "prehend recording diff a.mcap other.mcap --tolerances ";
  EXPECT_EQ(run(diff + "wide.toml").code, 0);
  EXPECT_THAT(run(diff + "wrong.toml").complaint, HasSubstr("wrong.toml"));
  EXPECT_EQ(run(diff + "wrong.toml").code, 3);
}

// Another day, and one sample was lost: only that one is missing, whatever the times of arrival.
TEST_F(RecordingCommand, DiffAlignsByOrigin) {
  make("a.mcap");
  make("other.mcap", {.without_seventh = true, .later_ns = 12'345'678'901});
  const Answer answer = run("prehend recording diff a.mcap other.mcap");
  EXPECT_EQ(answer.code, 1);
  EXPECT_THAT(answer.output,
              HasSubstr("9 compared, 1 different, 1 missing\n    origin 1700000000.600000 s"));
  EXPECT_THAT(answer.output, HasSubstr("9 compared, 0 different"));
  EXPECT_THAT(run("prehend recording diff other.mcap a.mcap").output,
              HasSubstr("1 more than expected"));
}

TEST_F(RecordingCommand, RecordsAreWrittenBackByteForByte) {
  make("a.mcap");
  ASSERT_EQ(run("prehend recording records a.mcap > a.json").code, 0);
  // The specification's reference writer compresses nothing: so the second round is the same bytes.
  ASSERT_EQ(run("prehend recording write a.json -o b.mcap").code, 0);
  ASSERT_EQ(run("prehend recording records b.mcap > b.json").code, 0);
  ASSERT_EQ(run("prehend recording write - -o c.mcap < b.json").code, 0);
  EXPECT_EQ(testing::file_bytes(scratch_ / "b.mcap"), testing::file_bytes(scratch_ / "c.mcap"));
  EXPECT_EQ(run("prehend recording diff a.mcap b.mcap").code, 0);
  EXPECT_EQ(run("echo '{}' | prehend recording write -o d.mcap").code, 1);
  // The file is closed on its first record that is wrong: deep documents used to end the program.
  const std::string deep(100'000, '['), shut(100'000, ']');
  testing::write_bytes(scratch_ / "deep.json",
                       std::string("{\"records\": [{\"type\": \"Header\", \"fields\": "
                                   "[[\"library\", \"\"], [\"profile\", \"\"]]}, {\"type\": "
                                   "\"Message\", \"fields\": [[\"channel_id\", ") +
                           deep + shut + "]]}]}");
  const Answer answer = run("prehend recording write deep.json -o d.mcap");
  EXPECT_EQ(answer.code, 1);
  EXPECT_THAT(answer.complaint, HasSubstr("too many lists inside each other"));
}

std::string little_endian(std::uint64_t value) {
  std::string bytes;
  for (int i = 0; i < 8; ++i, value >>= 8) bytes += static_cast<char>(value & 0xff);
  return bytes;
}

std::string record_of(char opcode, const std::string& content) {
  return opcode + little_endian(content.size()) + content;
}

TEST_F(RecordingCommand, RecordsThatAreWrongAreSaid) {
  const std::string header =
      "{\"type\": \"Header\", \"fields\": [[\"library\", \"\"], "
      "[\"profile\", \"\"]]}";
  testing::write_bytes(scratch_ / "open.json", "{\"records\": [" + header + "]}");
  testing::write_bytes(
      scratch_ / "flat.json",
      "{\"meta\": {\"variant\": {\"features\": 7}}, \"records\": [" + header + "]}");
  make_unfinished("killed.mcap");
  // A header; a chunk without times and compression, and in it another one.
  const std::string inner = record_of(6, "");
  testing::write_bytes(
      scratch_ / "nested.mcap",
      "\x89MCAP0\r\n" + record_of(1, std::string(8, 0)) +
          record_of(6, std::string(16, 0) + little_endian(inner.size()) + std::string(8, 0) +
                           little_endian(inner.size()) + inner));
  for (const auto& [command, says] :
       {std::pair("write open.json -o x.mcap", "open.json: no DataEnd among the records (put one "),
        std::pair("write flat.json -o x.mcap", "flat.json: meta: meta.variant.features is no list"),
        std::pair("records killed.mcap", ": the file has no footer (prehend recording recover"),
        std::pair("records nested.mcap", ": damaged: a chunk inside a chunk")}) {
    const Answer wrong = run(std::string("prehend recording ") + command);
    EXPECT_EQ(wrong.code, 1) << command;
    EXPECT_THAT(wrong.complaint, HasSubstr(says)) << command;
  }
}

TEST_F(RecordingCommand, TheExamplesOfTheReadmeRun) {
  make("demo.mcap");
  make("other.mcap");
  make_unfinished("killed.mcap");
  const auto page = testing::file_bytes(test::in_sources("services/recorder/README.md"));
  const std::string text(page.begin(), page.end());
  const std::string fence = "```sh\n";
  const std::size_t begin = text.find(fence, text.find("## Recordings as files")) + fence.size();
  std::string example = text.substr(begin, text.find("```", begin) - begin);
  for (std::size_t at; (at = example.find("hand/")) != std::string::npos;)
    example.replace(at, 5, "robot/");  // what is in these recordings
  for (std::size_t at; (at = example.find("robot/posture")) != std::string::npos;)
    example.replace(at, 13, "robot/command");
  const Answer answer = run("set -e\n" + example);
  EXPECT_EQ(answer.code, 0) << answer.output << answer.complaint;
  EXPECT_THAT(answer.output, HasSubstr("whole.mcap"));
  for (const char* name : {"posture.csv", "tables/robot-command.jsonl", "same.mcap"})
    EXPECT_TRUE(std::filesystem::exists(scratch_ / name)) << name;
}

TEST_F(RecordingCommand, EverySubcommandHasHelp) {
  for (const char* command :
       {"info", "cut", "merge", "verify", "recover", "export", "diff", "records", "write"}) {
    EXPECT_EQ(run(fmt::format("prehend recording {} --help", command)).code, 0) << command;
    EXPECT_EQ(run(fmt::format("prehend recording {} --colour red", command)).code, 2) << command;
  }
  EXPECT_EQ(run("prehend recording").code, 2);
}

}  // namespace
}  // namespace prehend::recorder
