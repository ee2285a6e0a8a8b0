// Guards every numeric option: CLI11 takes nan, inf and 1e309 for numbers within any range, an
// empty word for 0, and 010 for 8.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <string>
#include <vector>

#include "common/tool/program.hpp"

namespace prehend::tool {
namespace {

struct Options {
  double free = 1, ranged = 1;
  std::optional<double> perhaps;
  int whole = 1;
  std::uint64_t seed = 1;
  std::vector<double> list;
  std::string text;
};

/// The exit code, or nothing when the arguments are taken.
std::optional<int> parsed(Options& options, const std::vector<std::string>& arguments) {
  CLI::App app("Tries options.", "try");
  auto* command = app.add_subcommand("command", "has them");
  command->add_option("--free", options.free);
  command->add_option("--ranged", options.ranged)->check(CLI::Range(0.5, 1e6));
  command->add_option("--perhaps", options.perhaps);
  command->add_option("--whole", options.whole)->check(CLI::Range(-5, 100));
  command->add_option("--seed", options.seed);
  command->add_option("--list", options.list)->delimiter(',');
  command->add_option("--text", options.text);
  return parse(app, arguments);
}

TEST(Numbers, WhatIsNoFiniteNumberIsWrongUseOfEveryKindOfOption) {
  for (const char* option : {"--free", "--ranged", "--perhaps", "--whole", "--seed", "--list"})
    for (const char* word : {"nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e309", "-1e309", "",
                             " ", "5m", "5 m", "0x10", "five", "+", "-", "+-1", "--"}) {
      Options options;
      testing::internal::CaptureStderr();
      EXPECT_EQ(parsed(options, {"command", std::string(option) + "=" + word}), exit_wrong_use)
          << option << "=" << word;
      const std::string said = testing::internal::GetCapturedStderr();
      EXPECT_NE(said.find(option), std::string::npos) << said;
    }
  Options options;
  EXPECT_EQ(parsed(options, {"command", "--list=1,nan,2"}), exit_wrong_use);
  EXPECT_EQ(parsed(options, {"command", "--seed=-1"}), exit_wrong_use);
  EXPECT_EQ(parsed(options, {"command", "--whole=1e1"}), exit_wrong_use);
  EXPECT_EQ(parsed(options, {"command", "--whole=99999999999999999999999"}), exit_wrong_use);
}

TEST(Numbers, FiniteOnesAreTaken) {
  Options options;
  ASSERT_FALSE(
      parsed(options, {"command", "--free=-0", "--ranged=1e6", "--perhaps=+2.5", "--whole=010",
                       "--seed=18446744073709551615", "--list=1,-2.5e-3", "--text=nan"}));
  EXPECT_EQ(options.free, 0);
  EXPECT_EQ(options.ranged, 1e6);
  EXPECT_EQ(options.perhaps, 2.5);
  EXPECT_EQ(options.whole, 10);  // not 8
  EXPECT_EQ(options.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(options.list, (std::vector<double>{1, -2.5e-3}));
  EXPECT_EQ(options.text, "nan");
  ASSERT_FALSE(parsed(options, {"command", "--free", "5e-400", "--whole", "-5"}));
  EXPECT_EQ(options.free, 0);  // too small for a double
  EXPECT_EQ(options.whole, -5);
}

}  // namespace
}  // namespace prehend::tool
