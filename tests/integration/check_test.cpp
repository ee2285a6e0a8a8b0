// `prehend check`: services as real processes on recorded inputs. The same recording must give the
// same answers, to the byte, however often it is asked; what has changed must be seen, shown,
// written as JUnit XML and, on request, taken over.
#include "services/recorder/tools/check/check.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "common/recording/mcap/writer.hpp"
#include "common/recording/types/idl.hpp"
#include "common/recording/types/value.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

using nlohmann::json;
using recorder::Played;
using recorder::Tape;

const std::string samples = test::in_sources("deploy/samples");

std::vector<std::filesystem::path> all_samples() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(samples))
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
  return files;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Check : public Rig {
 protected:
  std::string file(const std::string& name) { return (folder_ / name).string(); }
  std::string copy_of(const std::string& sample, const std::string& name) {
    std::filesystem::copy_file(samples + "/" + sample, file(name));
    return file(name);
  }
  Answer check(const std::string& recording, Strings more = {}, int limit_s = 120) {
    Strings arguments{"check", recording, "--quiet", "--domain", std::to_string(domain_)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run("prehend", arguments, limit_s);
  }
  /// The glove then tells another user: an answer that has changed.
  static Strings changed(Strings more = {}) {
    more.insert(more.end(), {"--service", "glove", "--set", "glove.user=<\"somebody\" & others>"});
    return more;
  }
  /// All that is fed to services: what no service answers.
  static std::vector<std::vector<std::uint8_t>> inputs(const std::string& path) {
    auto tape = Tape::open({path}, [](const std::string& topic) {
      return topic == "glove/frame" || topic == "camera/image" || topic == "operator/command";
    });
    std::vector<std::vector<std::uint8_t>> payloads;
    while (const auto one = tape.value().next()) payloads.push_back(one->sample.payload);
    return payloads;
  }
};

TEST_F(Check, SamplesAreAnsweredAsRecordedTimeAndAgain) {
  const int runs = std::getenv("PREHEND_LONG") ? 20 : 3;
  const auto types = recording::types::load_contract().value();
  const auto tolerances = recording::ToleranceTable::load_defaults().value();
  std::uintmax_t bytes = 0;
  for (const auto& sample : all_samples()) {
    bytes += std::filesystem::file_size(sample);
    std::optional<recorder::Checked> first;
    for (int i = 0; i < runs; ++i) {
      recorder::CheckOptions options{.file = sample, .log_folder = folder_};
      options.lab.domain = domain_;
      auto checked = recorder::check(options, types, tolerances, [](double) {});
      ASSERT_TRUE(checked) << checked.error().message();
      for (const auto& topic : checked->report.topics)
        EXPECT_EQ(topic.different, 0u) << sample << " " << topic.name << " "
                                       << (topic.first.empty() ? "" : topic.first[0].text());
      EXPECT_GE(checked->report.topics.size(), 4u);
      if (!first) {
        first.emplace(std::move(*checked));
        continue;
      }
      ASSERT_EQ(checked->answers.size(), first->answers.size());
      for (const auto& [topic, answers] : checked->answers) {
        const auto& before = first->answers[topic];
        ASSERT_EQ(answers.size(), before.size()) << topic;
        for (std::size_t k = 0; k < answers.size(); ++k) {
          EXPECT_EQ(answers[k].payload, before[k].payload) << topic << k;
          EXPECT_EQ(answers[k].kind, before[k].kind) << topic << k;
          EXPECT_EQ(answers[k].received, before[k].received) << topic << k;
        }
      }
    }
  }
  EXPECT_GE(all_samples().size(), 2u);
  EXPECT_LT(bytes, 2'000'000u);
}

TEST_F(Check, EachServiceAloneAnswersAsInCompany) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> services{
      {"glove", {"hand/posture"}},
      {"recognition", {"object/detection"}},
      {"mapping", {"glove/feedback", "robot/command"}},
      {"simulation",
       {"grasp/report", "object/state", "robot/state", "robot/touch", "scene/state"}}};
  for (const auto& [service, topics] : services) {
    const Answer answer =
        check(samples + "/intelligent-grasp.mcap", {"--service", service, "--json"});
    EXPECT_EQ(answer.exit_code, 0) << service << answer.output << answer.log;
    const json document = json::parse(answer.output);
    std::vector<std::string> named;
    for (const auto& topic : document["topics"]) {
      named.push_back(topic["name"]);
      EXPECT_GT(topic["compared"], 0);
      EXPECT_FALSE(topic.contains("first_difference"));
    }
    std::sort(named.begin(), named.end());
    EXPECT_EQ(named, topics);
  }
}

// A search takes seconds and goes on beside everything else; in lockstep what is found when follows
// from the recording, also on a machine that knows the plan already. A search lets all others go
// first and takes minutes beside other tests; these would be recorded, and played again each time.
TEST_F(Check, GraspsArePlannedAgainAsTheyWere) {
  const std::string recording = file("planned.mcap");
  ::setenv("XDG_STATE_HOME", file("knows").c_str(), 1);
  const auto demo = [&](const Strings& more) {
    Strings arguments{
        "demo", "--mode", "planned", "--timeout", "240", "--domain", std::to_string(domain_)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Answer shown = run("prehend", arguments, 500);
    ASSERT_TRUE(shown.exit_code == 0 || shown.exit_code == 1) << shown.log;
  };
  demo({});
  ASSERT_TRUE(std::filesystem::exists(file("knows/prehend/grasps/barrett")));
  demo({"--record", recording});
  constexpr int searching = 400;  // s, at most, beside other tests
  const Answer update = check(recording, {"--update"}, searching);
  ASSERT_EQ(update.exit_code, 0) << update.log;
  const Answer alone = check(recording, {"--service", "planner"}, searching);
  EXPECT_EQ(alone.exit_code, 0) << alone.output << alone.log;
  ::setenv("XDG_STATE_HOME", file("knows nothing").c_str(), 1);
  const Answer again = check(recording, {"--json"}, searching);
  EXPECT_EQ(again.exit_code, 0) << again.output << again.log;
  std::map<std::string, int> compared;
  const json document = json::parse(again.output);
  for (const auto& topic : document["topics"]) compared[topic["name"]] = topic["compared"];
  EXPECT_GE(compared["grasp/candidates"], 2) << "first ones, and all";
  EXPECT_GT(compared["robot/command"], 100);
}

TEST_F(Check, WhatHasChangedIsShownAndWrittenAsJUnit) {
  // A name that XML must not take as it is.
  const std::string sample = copy_of("direct-grasp.mcap", "a & \"b\" <c>.mcap");
  const Answer same = check(sample, {"--service", "glove", "--junit", file("same.xml")});
  EXPECT_EQ(same.exit_code, 0) << same.log;
  EXPECT_NE(same.output.find("all the same"), std::string::npos) << same.output;
  EXPECT_EQ(same.log, "");
  const Answer other = check(sample, changed({"--json", "--junit", file("other.xml")}));
  EXPECT_EQ(other.exit_code, 1) << other.output << other.log;
  const json document = json::parse(other.output);
  EXPECT_EQ(document["verdict"], "different");
  ASSERT_EQ(document["topics"].size(), 1u);
  EXPECT_EQ(document["topics"][0]["name"], "hand/posture");
  const std::string difference = document["topics"][0]["first_difference"];
  EXPECT_NE(difference.find("user: expected"), std::string::npos) << difference;
  EXPECT_NE(difference.find("somebody"), std::string::npos) << difference;

  for (const bool failed : {false, true}) {
    tinyxml2::XMLDocument xml;
    ASSERT_EQ(xml.LoadFile(file(failed ? "other.xml" : "same.xml").c_str()), tinyxml2::XML_SUCCESS);
    const auto* suite = xml.FirstChildElement("testsuite");
    ASSERT_TRUE(suite);
    EXPECT_EQ(suite->Attribute("name"), sample);
    EXPECT_EQ(suite->IntAttribute("tests"), 1);
    EXPECT_EQ(suite->IntAttribute("failures"), failed ? 1 : 0);
    EXPECT_EQ(suite->IntAttribute("errors", -1), 0);
    EXPECT_GT(suite->DoubleAttribute("time"), 0);
    const auto* test = suite->FirstChildElement("testcase");
    ASSERT_TRUE(test);
    EXPECT_FALSE(test->NextSiblingElement());
    EXPECT_STREQ(test->Attribute("name"), "hand/posture");
    EXPECT_EQ(test->Attribute("classname"), sample);
    const auto* failure = test->FirstChildElement("failure");
    ASSERT_EQ(failure != nullptr, failed);
    if (!failure) continue;
    EXPECT_STREQ(failure->GetText(), difference.c_str());
    const std::string count = std::to_string(document["topics"][0]["different"].get<int>());
    EXPECT_EQ(std::string(failure->Attribute("message")).find(count + " of "), 0u);
  }
}

TEST_F(Check, UpdateShowsTheChangeAndTakesItOver) {
  const std::string sample = copy_of("direct-grasp.mcap", "a.mcap");
  const std::string again = copy_of("direct-grasp.mcap", "b.mcap");
  const auto before = inputs(sample);
  const std::string untouched = text_of(sample);
  EXPECT_EQ(check(sample, {"--service", "glove", "--update"}).exit_code, 0);
  EXPECT_EQ(text_of(sample), untouched) << "nothing had changed";
  const Answer update = check(sample, changed({"--update"}));
  EXPECT_EQ(update.exit_code, 0) << update.log;
  EXPECT_NE(update.output.find("user: expected"), std::string::npos) << update.output;
  EXPECT_NE(update.log.find("now holds these answers"), std::string::npos) << update.log;
  EXPECT_EQ(check(sample, changed()).exit_code, 0);
  EXPECT_EQ(check(sample, {"--service", "glove"}).exit_code, 1);  // the old answers are gone
  EXPECT_EQ(inputs(sample), before);
  EXPECT_EQ(run("prehend", {"recording", "verify", sample}, 20).exit_code, 0);
  // Whoever updates gets the same file.
  EXPECT_EQ(check(again, changed({"--update"})).exit_code, 0);
  EXPECT_TRUE(text_of(again) == text_of(sample));
}

// Cycles were counted from the first message, which was an answer where the recorder came before
// the cameras: its time changed with the update, and the next check had cycles of other times.
TEST_F(Check, WhatBeginsWithAnAnswerIsTheSameAfterAnUpdate) {
  const std::string part = file("part.mcap");
  ASSERT_EQ(run("prehend",
                {"recording", "cut", samples + "/intelligent-grasp.mcap", "--from", "2.012",
                 "--until", "2.6", "--topic", "robot/*", "object/*", "scene/*", "glove/*", "hand/*",
                 "camera/*", "-o", part},
                20)
                .exit_code,
            0);
  EXPECT_EQ(check(part, {"--update"}).exit_code, 0);
  const Answer again = check(part);
  EXPECT_EQ(again.exit_code, 0) << again.output << again.log;
}

/// What the hands of a recording were told, by their names.
std::map<std::string, std::size_t> commands_by_hand(const std::string& path) {
  auto tape = Tape::open({path}, [](const std::string& topic) { return topic == "robot/command"; });
  const auto types = recording::types::load_contract().value();
  std::map<std::string, std::size_t> counts;
  while (const auto one = tape.value().next()) {
    const auto command =
        recording::types::decode(*types.find(one->stream->topic.type), one->sample.payload);
    if (command) ++counts[std::get<std::string>(command->find("hand")->content)];
  }
  return counts;
}

// Two mappings write one topic, and two gloves another: each is run again with its own settings,
// and who of two is first does not depend on the machine.
TEST_F(Check, TwoHandsAnswerAsRecorded) {
  const std::string two = file("two.mcap");
  const auto shown = run("prehend",
                         {"demo", "--hands", "left:barrett,right:barrett", "--seed", "1", "--quiet",
                          "--record", two, "--timeout", "8", "--domain", std::to_string(domain_)},
                         120);
  ASSERT_TRUE(std::filesystem::exists(two)) << shown.log;
  EXPECT_EQ(check(two, {"--update"}).exit_code, 0);
  const Answer again = check(two, {"--json"});
  EXPECT_EQ(again.exit_code, 0) << again.output << again.log;
  const auto counts = commands_by_hand(two);
  ASSERT_EQ(counts.size(), 2U);
  for (const auto& [hand, count] : counts) EXPECT_GT(count, 100U) << hand;
  const Answer alone = check(two, {"--service", "mapping"});
  EXPECT_EQ(alone.exit_code, 0) << alone.output << alone.log;
}

TEST_F(Check, WhatCannotBeFoundOutIsNoVerdict) {
  const auto expect_broken = [&](const Answer& answer, const std::string& reason) {
    EXPECT_EQ(answer.exit_code, 3) << reason << answer.output;
    EXPECT_NE(answer.log.find(reason), std::string::npos) << answer.log;
    EXPECT_EQ(answer.output, "");
  };
  // Damaged: half of it would be compared with all of the answers.
  std::string bytes = text_of(samples + "/direct-grasp.mcap");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  std::ofstream(file("damaged.mcap"), std::ios::binary) << bytes;
  expect_broken(check(file("damaged.mcap")), "damaged.mcap at byte");
  // A service that does not start is named with its last words.
  const std::string missing = file("no.model");
  expect_broken(check(samples + "/intelligent-grasp.mcap",
                      {"--service", "mapping", "--set", "mapping.model=" + missing}),
                missing);
  // Only inputs.
  ASSERT_EQ(run("prehend",
                {"recording", "cut", samples + "/direct-grasp.mcap", "--topic", "glove/frame", "-o",
                 file("inputs.mcap")},
                20)
                .exit_code,
            0);
  expect_broken(check(file("inputs.mcap")), "nothing that a service answered");
  expect_broken(check(samples + "/direct-grasp.mcap", {"--service", "recognition"}),
                "holds no answer of recognition");
  // A message of 1970 among those of today used to be waited for in steps of 10 ms.
  {
    auto writer = recording::mcap::Writer::create(file("long.mcap")).value();
    const auto channel = writer.add_channel(0, "hand/posture", "cdr").value();
    for (const std::uint64_t time : {1ull, 1'700'000'000'000'000'000ull})
      ASSERT_TRUE(writer.write(
          recording::mcap::Message{channel, 1, time, time, recording::mcap::view("0123")}));
  }
  expect_broken(check(file("long.mcap")), "too long");
  // The verdict is there, but not where it was wanted.
  const Answer unwritten =
      check(samples + "/direct-grasp.mcap", {"--service", "glove", "--junit", "/nowhere/a.xml"});
  EXPECT_EQ(unwritten.exit_code, 3);
  EXPECT_NE(unwritten.log.find("/nowhere/a.xml"), std::string::npos) << unwritten.log;
}

TEST_F(Check, TheReadmeShowsALabHowToAddItsOwn) {
  const std::string page = text_of(test::in_sources("services/recorder/README.md"));
  const std::string fence = "```sh\n";
  const std::size_t begin = page.find(fence, page.find("## A recording as a test")) + fence.size();
  const std::string example = page.substr(begin, page.find("```", begin) - begin);
  ASSERT_NE(example.find("prehend check mine.mcap"), std::string::npos);
  std::ofstream(file("example.sh"))
      << "set -e\ncd " << folder_.string() << "\nPATH=" << test::in_programs("")
      << ":$PATH\nexport PREHEND_LAB_DOMAIN=" << domain_ << "\n"
      << example;
  stage::Process::Options options{.command = {"/bin/sh", file("example.sh")},
                                  .log = file("example.log")};
  auto process = stage::Process::start(options);
  ASSERT_TRUE(process);
  const auto exit = process->wait(seconds(150));
  ASSERT_TRUE(exit && exit->code == 0) << stage::last_lines(options.log, 20);
  const std::string said = text_of(options.log);
  // The last check, behind the update, finds nothing.
  const std::size_t verdict = said.rfind("same: ");
  EXPECT_NE(verdict, std::string::npos) << said;
  EXPECT_EQ(said.find("different: ", verdict), std::string::npos) << said;
}

}  // namespace
}  // namespace prehend::integration
