// What holds for every program there is. Every numeric option that any of them declares, as its
// help lists it, refuses what is no finite number: by wrong use and a message that names the
// option. An option that is added tomorrow is tried, too.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

struct Answer {
  int exit = -1;
  std::string text;  // both outputs
};

Answer run(const std::string& command) {
  Answer answer;
  std::FILE* pipe = ::popen((command + " 2>&1 </dev/null").c_str(), "r");
  if (!pipe) return answer;
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe))
    answer.text.append(part.data(), size);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) answer.exit = WEXITSTATUS(status);
  return answer;
}

struct Option {
  std::string command, name;  // the program with its subcommands; empty name: a positional
  bool whole = false;
};

/// First words of the lines of a section of CLI11's help.
std::vector<std::string> subcommands_in(const std::string& help) {
  std::vector<std::string> found;
  const std::size_t begin = help.find("\nSubcommands:\n");
  if (begin == std::string::npos) return found;
  static const std::regex name("\n  ([a-z][a-z0-9-]*) ");
  const std::string rest = help.substr(begin + 13);
  for (std::sregex_iterator at(rest.begin(), rest.end(), name), end; at != end; ++at)
    found.push_back((*at)[1]);
  return found;
}

/// Calls `see` with every command below this one, and its help.
template <class See>
void visit(const std::string& command, const See& see) {
  const Answer help = run(command + " --help");
  if (help.exit != 0) return;  // a program of another kind: it takes no options
  see(command, help.text);
  for (const std::string& below : subcommands_in(help.text)) visit(command + " " + below, see);
}

void find_options(const std::string& command, const std::string& help, std::vector<Option>& found) {
  static const std::regex option("\n +(?:-[a-z],)?(--[a-z][a-z0-9-]*)[^ ]* (FLOAT|INT|UINT)");
  for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at)
    found.push_back({command, (*at)[1], (*at)[2] != "FLOAT"});
}

/// The same of all commands there are.
template <class See>
void visit_all(const See& see) {
  for (const auto& entry : std::filesystem::directory_iterator(test::in_programs(""))) {
    const std::string name = entry.path().filename();
    if (name.starts_with("prehend-")) visit(entry.path().string(), see);
  }
  // The command line's own commands.
  const std::string prehend = test::in_programs("prehend");
  static const std::regex line("\n  ([a-z][a-z-]*) ");
  const Answer help = run(prehend + " --help");
  for (std::sregex_iterator at(help.text.begin(), help.text.end(), line), end; at != end; ++at)
    if (!std::filesystem::exists(test::in_programs("prehend-" + (*at)[1].str())))
      visit(prehend + " " + (*at)[1].str(), see);
}

std::vector<Option> all_options() {
  std::vector<Option> found;
  visit_all([&](const std::string& command, const std::string& help) {
    find_options(command, help, found);
  });
  return found;
}

// Guards objects of a lab of one's own, which only the shipped catalogue was asked for.
TEST(Options, WhoTakesAnObjectByItsNameTakesTheLabsCatalogue) {
  int commands = 0;
  static const std::regex object("\n +--objects? TEXT");
  visit_all([&](const std::string& command, const std::string& help) {
    if (!std::regex_search(help, object) || command.ends_with("prehend-benchmark")) return;
    ++commands;
    EXPECT_TRUE(help.find("--catalogue ") != std::string::npos ||
                help.find("--config ") != std::string::npos)
        << command;
  });
  EXPECT_GE(commands, 6);
}

// Every program goes through one place that notices it: what was printed and found no room is an
// error.
TEST(Output, ThatIsNotWrittenIsAnErrorOfEveryProgram) {
  int programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::in_programs(""))) {
    const std::string name = entry.path().filename();
    if (name != "prehend" && !name.starts_with("prehend-")) continue;
    if (run(entry.path().string() + " --help").exit != 0) continue;  // a helper of other tests
    ++programs;
    const Answer answer = run("(" + entry.path().string() + " --help >/dev/full)");
    EXPECT_EQ(answer.exit, 3) << name;
    EXPECT_NE(answer.text.find("standard output"), std::string::npos) << name << answer.text;
  }
  EXPECT_GT(programs, 20);
}

TEST(Options, ThatTakeNumbersRefuseWhatIsNone) {
  const std::vector<Option> options = all_options();
  EXPECT_GT(options.size(), 100u);  // else the help is read wrongly
  std::set<std::string> commands;
  for (const Option& option : options) {
    commands.insert(option.command);
    for (const char* word : {"nan", "inf", "-inf", "1e309", "''", "5m"}) {
      const Answer answer = run(option.command + " " + option.name + "=" + word);
      EXPECT_EQ(answer.exit, 2) << option.command << ' ' << option.name << '=' << word << '\n'
                                << answer.text;
      EXPECT_NE(answer.text.find(option.name + ": "), std::string::npos)
          << option.command << ' ' << word << '\n'
          << answer.text;
    }
  }
  EXPECT_GT(commands.size(), 30u);
}

}  // namespace
}  // namespace prehend
