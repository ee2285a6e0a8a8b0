// --log json: every line that a service or a command says is a JSON object, whatever goes wrong.
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "common/base/file_text.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

using Json = nlohmann::json;

/// The objects of a log; fails where a line is none, or lacks what each must have.
std::vector<Json> objects(const std::string& log) {
  static const std::regex date(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z)");
  std::vector<Json> all;
  std::istringstream lines(log);
  for (std::string text; std::getline(lines, text);) {
    const Json line = Json::parse(text, nullptr, false);
    if (!line.is_object() || !line.contains("message") || !line.contains("service") ||
        !std::regex_match(line.value("time", ""), date) || line.value("level", "").empty())
      ADD_FAILURE() << "no line of the log: " << text;
    else
      all.push_back(line);
  }
  return all;
}

class Logs : public Rig {
 protected:
  /// The commands that `prehend --help` names.
  Strings commands() {
    const std::string help = run("prehend", {"--help"}, 30).output;
    static const std::regex row("\n  ([a-z][a-z-]*) +");
    Strings found;
    for (std::sregex_iterator at(help.begin(), help.end(), row), end; at != end; ++at)
      found.push_back((*at)[1]);
    return found;
  }
};

TEST_F(Logs, AServiceSaysAllOfItsLifeInJson) {
  const std::string shown = "lab.scene=" + scene(1);
  for (const char* name : {"glove", "recognition", "mapping", "simulation"}) {
    Strings arguments = lab_arguments({shown});
    arguments.insert(arguments.end(), {"--log", "json", "--verbose"});
    auto process = start_program("prehend-" + std::string(name), arguments);
    ASSERT_EQ(run("prehend", with_lab({"status", "--wait", name, "--timeout", "60"}), 90).exit_code,
              0);
    process.signal(SIGTERM);
    ASSERT_TRUE(process.wait(seconds(20)));
    const auto said = objects(read_file(process.log()).value());
    ASSERT_FALSE(said.empty());
    EXPECT_EQ(said.back()["message"], "stopped");
    EXPECT_EQ(said.back()["service"], name);
    EXPECT_EQ(said.back()["rig"], name_);
  }
}

TEST_F(Logs, AnErrorOfAServiceHasItsParts) {
  const std::string missing = (folder_ / "no \"such\"\n\x1b[2J scene.toml").string();
  Strings arguments = lab_arguments({"lab.scene=" + missing});
  arguments.push_back("--log=json");
  const Answer answer = run("prehend-simulation", arguments, 30);
  EXPECT_EQ(answer.exit_code, 3);
  const auto said = objects(answer.log);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0]["level"], "error");
  EXPECT_EQ(said[0]["where"], missing);
  EXPECT_FALSE(said[0]["what"].get<std::string>().empty());
}

TEST_F(Logs, EveryCommandComplainsInJson) {
  const Strings all = commands();
  ASSERT_GT(all.size(), 20u);
  for (const std::string& command : all) {
    const Answer answer = run("prehend", {command, "--log", "json", "--no-such-option"}, 30);
    EXPECT_EQ(answer.exit_code, 2) << command << answer.log;
    const auto said = objects(answer.log);
    ASSERT_EQ(said.size(), 1u) << command << ": " << answer.log;
    EXPECT_EQ(said[0]["level"], "error") << command;
    EXPECT_TRUE(said[0].contains("what")) << command;
  }
}

TEST_F(Logs, TheEnvironmentChoosesForAll) {
  stage::Process::Options options;
  options.command = {program("prehend"), "no-such-command"};
  options.log = folder_ / "chosen.log";
  options.environment = {{"PREHEND_LOG", "json"}};
  auto process = stage::Process::start(options);
  ASSERT_TRUE(process);
  ASSERT_TRUE(process->wait(seconds(30)));
  EXPECT_EQ(objects(read_file(options.log).value()).size(), 1u);
}

}  // namespace
}  // namespace prehend::integration
