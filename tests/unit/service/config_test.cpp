// lab.toml: defaults, file, environment and overrides in this order; whatever is misspelt or of the
// wrong type is an error that names the place.
#include "common/service/config.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/paths/paths.hpp"

namespace prehend::service {
namespace {

std::filesystem::path write(const std::string& text) {
  const auto file =
      std::filesystem::temp_directory_path() / ("lab-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << text;
  return file;
}

TEST(Config, AFileWithoutANameIsRefused) {
  const auto config = Config::load("");  // it was an exception that nobody caught
  ASSERT_FALSE(config);
  EXPECT_FALSE(config.error().message().empty());
}

TEST(Config, LaterSourcesWin) {
  const auto file = write("[glove]\nrate = 40\nuser = \"ann\"\n[camera]\nfocal = [500, 510.5]\n");
  auto config = Config::load(file);
  ASSERT_TRUE(config) << config.error().message();
  EXPECT_EQ(config->number("glove.rate"), 40) << "a whole number is a number too";
  EXPECT_EQ(config->integer("glove.baud"), 115200);
  EXPECT_EQ(config->numbers("camera.focal"), (std::vector<double>{500, 510.5}));

  setenv("PREHEND_GLOVE_RATE", "50", 1);
  EXPECT_EQ(Config::load(file)->number("glove.rate"), 50);
  EXPECT_EQ(Config::load(file, {"glove.rate=60.5", "glove.user=bob"})->number("glove.rate"), 60.5);
  EXPECT_EQ(Config::load(file, {"glove.user=bob"})->text("glove.user"), "bob");
  unsetenv("PREHEND_GLOVE_RATE");
}

TEST(Config, TheShippedFileIsValid) {
  const auto config = Config::load(test::in_sources("deploy/lab.toml"));
  EXPECT_TRUE(config) << config.error().message();
}

TEST(Config, PathsAreMeantFromTheFile) {
  const auto file = write("[glove]\nfile = \"hand.csv\"\n");
  const auto config = Config::load(file);
  EXPECT_EQ(config->path("glove.file"), file.parent_path() / "hand.csv");
  EXPECT_TRUE(Config::load(file, {"glove.file="})->path("glove.file").empty());
  EXPECT_EQ(Config::load(file, {"glove.file=/a/b"})->path("glove.file"), "/a/b");
}

TEST(Config, ItsTextsMakeItAgain) {
  const auto file = write(
      "[glove]\nrate = 33.3\nuser = \"ann b\"\nsites = [\"thumb\", \"back_of_hand\"]\n"
      "[camera]\nfocal = [500, 510.5]\n");
  const auto config = Config::load(file);
  ASSERT_TRUE(config);
  std::vector<std::string> overrides;
  for (const auto& [key, value] : config->texts()) overrides.push_back(key + "=" + value);
  const auto again = Config::load(write(""), overrides);
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->texts(), config->texts());
  EXPECT_EQ(again->number("glove.rate"), 33.3);
  EXPECT_EQ(again->text("glove.user"), "ann b");
  EXPECT_EQ(again->numbers("camera.focal"), (std::vector<double>{500, 510.5}));
  EXPECT_EQ(again->names("glove.sites"), (std::vector<std::string>{"thumb", "back_of_hand"}));
}

// What somebody has said, though it is the default, differs from what nobody has said: a robot's
// default is its own.
TEST(Config, KnowsWhatWasGiven) {
  const auto file = write("[safety]\ndeadman = false\n");
  EXPECT_TRUE(Config::load(file)->is_given("safety.deadman"));
  EXPECT_FALSE(Config::load(file)->is_given("safety.on_stop"));
  const auto empty = write("");
  EXPECT_FALSE(Config::load(empty)->is_given("safety.deadman"));
  EXPECT_FALSE(Config::load(empty)->texts().contains("safety.deadman"));
  EXPECT_TRUE(Config::load(empty, {"safety.deadman=false"})->is_given("safety.deadman"));
  EXPECT_TRUE(Config::load(file)->overridden().empty()) << "what the file says is no override";
  EXPECT_EQ(Config::load(file, {"gate.box=[1, 2]", "glove.name=left"})->overridden(),
            (std::map<std::string, std::string>{{"gate.box", "[1, 2]"}, {"glove.name", "left"}}));
  setenv("PREHEND_SAFETY_DEADMAN", "false", 1);
  EXPECT_TRUE(Config::load(empty)->is_given("safety.deadman"));
  EXPECT_EQ(Config::load(empty)->texts().at("safety.deadman"), "false");
  unsetenv("PREHEND_SAFETY_DEADMAN");
}

TEST(Config, MistakesAreNamed) {
  const std::pair<const char*, const char*> files[] = {
      {"[glove]\nrat = 40\n", "glove.rat"},
      {"[glove]\nrat = 40\n", "did you mean glove.rate"},
      {"[glove]\nrat = 40\n", ": line 2"},
      {"[glove]\nrate = \"fast\"\n", "a finite number"},
      {"[glvoe]\nrate = 3\n", "glvoe.rate"},
      {"rate = 3\n", "rate"},
      {"[glove\n", ": line 1"},
      {"[lab]\ndomain = 1.5\n", "whole number"},
  };
  for (const auto& [text, expected] : files) {
    const auto config = Config::load(write(text));
    ASSERT_FALSE(config) << text;
    EXPECT_NE(config.error().message().find(expected), std::string::npos)
        << config.error().message();
    EXPECT_EQ(config.error().message().find('\n'), std::string::npos) << "one line";
  }
  const auto file = write("");
  for (const char* text : {"glove.rat=3", "glove.rate", "glove.rate=fast", "glove.rate=[1]", "=3",
                           "glove.sites=[1]", "glove.sites=thumb"})
    EXPECT_FALSE(Config::load(file, {text})) << text;
  EXPECT_FALSE(Config::load("/nowhere/lab.toml"));
}

// A misspelt variable that is passed over leaves off what it should have switched on: keys above
// all.
// Guards ranges: nan passes every comparison with a bound.
TEST(Config, NumbersAreFiniteWhereverTheyComeFrom) {
  const auto file = write("[glove]\nrate = 40\n");
  for (const char* word : {"nan", "inf", "-inf", "1e309", "", "5m", "1\n[glove]\nrate = nan"}) {
    for (const ConfigKey& key : config_keys()) {
      const bool listed = std::holds_alternative<std::vector<double>>(key.fallback);
      if (!listed && !std::holds_alternative<double>(key.fallback) &&
          !std::holds_alternative<std::int64_t>(key.fallback))
        continue;
      const std::string value = listed ? "[1.0, " + std::string(word) + "]" : word;
      if (listed && *word == 0) continue;  // [1.0, ] is a list
      const std::string name(key.name);
      const auto set = Config::load(file, {name + "=" + value});
      ASSERT_FALSE(set) << name << "=" << value;
      EXPECT_NE(set.error().message().find(name), std::string::npos) << set.error().message();
    }
    setenv("PREHEND_GLOVE_RATE", word, 1);
    EXPECT_FALSE(Config::load(file)) << word;
    unsetenv("PREHEND_GLOVE_RATE");
    EXPECT_FALSE(Config::load(write("[glove]\nrate = " + std::string(word) + "\n"))) << word;
    write("[glove]\nrate = 40\n");
  }
}

// Guards --config FOLDER, which ran with defaults.
TEST(Config, AFolderIsNoConfiguration) {
  const auto config = Config::load(std::filesystem::temp_directory_path());
  ASSERT_FALSE(config);
  EXPECT_NE(config.error().message().find(std::filesystem::temp_directory_path()),
            std::string::npos);
}

TEST(Config, MisspeltVariablesAreNamed) {
  const auto file = write("");
  for (const auto& [name, meant] : std::initializer_list<std::pair<const char*, const char*>>{
           {"PREHEND_LAB_KEY", "did you mean PREHEND_LAB_KEYS?"},
           {"PREHEND_LABNETWORK", "did you mean PREHEND_LAB_NETWORK?"},
           {"PREHEND_SEDE", "did you mean PREHEND_SEED?"},
           {"PREHEND_", "did you mean"}}) {
    setenv(name, "x", 1);
    const auto config = Config::load(file);
    unsetenv(name);
    ASSERT_FALSE(config) << name;
    EXPECT_EQ(config.error().where, name);
    EXPECT_NE(config.error().message().find(meant), std::string::npos) << config.error().message();
  }
  for (const std::string& name : other_variables()) {
    const char* before = std::getenv(name.c_str());
    if (!before) setenv(name.c_str(), "", 1);
    EXPECT_TRUE(Config::load(file)) << name;
    if (!before) unsetenv(name.c_str());
  }
  setenv("PREHENDING", "x", 1);  // somebody else's
  EXPECT_TRUE(Config::load(file));
  unsetenv("PREHENDING");
}

}  // namespace
}  // namespace prehend::service
