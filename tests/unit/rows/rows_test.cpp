// A glove device, a camera, a hand, a mode is a row of one table (hands: a folder), and nothing
// else in the tree names it, so that adding one touches its own files and its row. This reads every
// string literal of the sources. A name with an underscore, or of a hand, is looked for as a word
// in all of them; an ordinary word (topic, folder, joints) only where a literal could mean the row:
// in the service that has the table, in prehend itself and in the configuration.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/model/hand_model.hpp"
#include "services/glove/devices/device.hpp"
#include "services/mapping/core/mapping_modes.hpp"
#include "services/recognition/cameras/camera.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

using Names = std::set<std::string>;

/// The string literals of C++ source, as they are written. Comments are none.
std::vector<std::string> literals(const std::string& text) {
  std::vector<std::string> found;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 2, "/*") == 0) {
      i = std::min(text.find("*/", i), text.size() - 2) + 1;
    } else if (text.compare(i, 2, "R\"") == 0) {
      const std::size_t open = text.find('(', i);
      std::string end(1, ')');
      end.append(text, i + 2, open - i - 2).push_back('"');
      const std::size_t close = text.find(end, open);
      found.push_back(text.substr(open + 1, close - open - 1));
      i = close + end.size() - 1;
    } else if (text[i] == '\'' && i > 0 && std::isdigit(static_cast<unsigned char>(text[i - 1]))) {
      continue;  // 10'000
    } else if (text[i] == '"' || text[i] == '\'') {
      const char quote = text[i];
      std::string literal;
      for (++i; i < text.size() && text[i] != quote; ++i) {
        if (text[i] == '\\') literal += text[i++];
        literal += text[i];
      }
      if (quote == '"') found.push_back(literal);
    }
  }
  return found;
}

/// Whether a word is in a text: no letter, digit or underscore beside it.
bool has_word(const std::string& text, const std::string& word) {
  const auto inside = [&](std::size_t at) {
    return at < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    if (!inside(at - 1) && !inside(at + word.size())) return true;
  return false;
}

/// What a search is for and where it does not apply.
struct Search {
  Names names;
  /// Where the rows are: the folder or file of the table.
  std::vector<std::string> home;
  /// Where an ordinary word would mean the row.
  std::vector<std::string> region;
  /// The key of lab.toml that takes a name: «key=name» means the row everywhere.
  std::string key{};
  /// Are the names ordinary words, unless they have an underscore?
  bool ordinary = true;
  /// File and literal that means something else, or has to stay as files on disk have it.
  std::set<std::pair<std::string, std::string>> homonyms{};
};

bool below(const std::string& path, const std::vector<std::string>& folders) {
  return std::any_of(folders.begin(), folders.end(),
                     [&](const std::string& folder) { return path.starts_with(folder); });
}

bool names_row(const Search& search, const std::string& path, const std::string& literal) {
  return std::any_of(search.names.begin(), search.names.end(), [&](const std::string& name) {
    if (!search.ordinary || name.find('_') != std::string::npos) return has_word(literal, name);
    return literal.ends_with(search.key + "=" + name) ||
           (below(path, search.region) && literal == name);
  });
}

/// «file: literal» of each that names a row.
std::vector<std::string> culprits(const Search& search) {
  std::vector<std::string> found;
  const std::filesystem::path root = test::in_sources("");
  for (const char* part : {"common", "services"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / part)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".hpp") continue;
      const std::string path = entry.path().lexically_relative(root).generic_string();
      if (below(path, search.home)) continue;
      std::ifstream stream(entry.path());
      const std::string text(std::istreambuf_iterator<char>(stream), {});
      EXPECT_FALSE(text.empty()) << path;
      for (const std::string& literal : literals(text))
        if (names_row(search, path, literal) && !search.homonyms.contains({path, literal}))
          found.push_back(path + ": " + literal);
    }
  return found;
}

std::string lines(const std::vector<std::string>& texts) {
  std::string text;
  for (const std::string& one : texts) text += one + "\n";
  return text;
}

template <class Rows>
Names names_of(const Rows& rows) {
  Names names;
  for (const auto& row : rows) names.emplace(row.name);
  return names;
}

TEST(Literals, AreFoundInSource) {
  const std::string source =
      "f(\"a\\\"b\", 'x', '\"'); // \"no\"\n/* \"no\" */ g(R\"(raw \"q\")\", 1'000, \"c\");";
  EXPECT_EQ(literals(source), (std::vector<std::string>{"a\\\"b", "raw \"q\"", "c"}));
}

TEST(Literals, ASearchFindsWhatNamesARow) {
  const Search search{.names = {"magic_glove", "topic"},
                      .home = {"services/x/"},
                      .region = {"services/cli/"},
                      .key = "glove.device"};
  EXPECT_TRUE(names_row(search, "common/a.cpp", "a magic_glove, or none"));
  EXPECT_FALSE(names_row(search, "common/a.cpp", "magic_gloves"));
  EXPECT_TRUE(names_row(search, "services/cli/a.cpp", "topic"));
  EXPECT_TRUE(names_row(search, "common/a.cpp", "glove.device=topic"));
  EXPECT_FALSE(names_row(search, "services/cli/a.cpp", "the topic of a message"));
  EXPECT_FALSE(names_row(search, "common/a.cpp", "topic"));
}

TEST(Rows, NobodyElseNamesAGloveDevice) {
  const auto found = culprits(
      {.names = names_of(glove::device_kinds()),
       .home = {"services/glove/devices/"},
       .region = {"services/glove/", "services/cli/", "common/service/"},
       .key = "glove.device",
       .homonyms = {{"services/cli/tools/dispatch.cpp", "recording"},  // prehend recording
                    {"services/glove/tools/filter_report_command.cpp", "recording"},  // JSON key
                    // What is checked comes from the recording.
                    {"services/recorder/tools/check/check.cpp", "glove.device=topic"},
                    // What is shown comes from a person who does not exist.
                    {"services/performer/tools/play/task_play.cpp", "glove.device=topic"},
                    // A table of users' files.
                    {"services/glove/core/joint_sensors.hpp", "joint_glove"}}});
  EXPECT_TRUE(found.empty()) << "ask the row (glove::DeviceKind, prehend glove devices):\n"
                             << lines(found);
}

TEST(Rows, NobodyElseNamesACamera) {
  const auto found = culprits(
      {.names = names_of(recognition::camera_kinds()),
       .home = {"services/recognition/cameras/"},
       .region = {"services/recognition/", "services/cli/", "common/service/"},
       .key = "recognition.source",
       .homonyms = {{"services/cli/service/outcome.cpp",
                     "device"},  // JSON key: the glove's
                                 // What is checked comes from the recording.
                    {"services/recorder/tools/check/check.cpp", "recognition.source=topic"},
                    // Names of arguments.
                    {"services/recognition/tools/objects/evaluate_command.cpp", "folder"},
                    {"services/recognition/tools/objects/train_command.cpp", "folder"}}});
  EXPECT_TRUE(found.empty()) << "ask the row (recognition::CameraKind, prehend camera sources):\n"
                             << lines(found);
}

// The study repeats findings of a thesis about its own three hands, and a driver of one maker's
// protocol moves that maker's hand; in no other place a hand is more than a folder. «human» is an
// ordinary word, which hands' files use for fingers.
TEST(Rows, NobodyNamesAHand) {
  Names names;
  for (const std::string& name : model::hand_names())
    if (name != "human") names.insert(name);
  ASSERT_GE(names.size(), 5u);
  const auto found = culprits({.names = names,
                               .home = {"services/mapping/tools/study/", "services/robot/core/"},
                               .ordinary = false,
                               // The device, which has the name of its hand.
                               .homonyms = {{"common/service/config_keys.cpp", "barrett"}}});
  EXPECT_TRUE(found.empty()) << "take the configuration's, or list model::hand_names():\n"
                             << lines(found);
}

TEST(Rows, NobodyElseNamesAWayToAnswer) {
  const auto found = culprits({.names = names_of(mapping::finger_modes),
                               .home = {"services/mapping/core/mapping_modes.hpp"},
                               .region = {"services/mapping/", "services/cli/", "common/service/"},
                               .key = "mapping.mode"});
  EXPECT_TRUE(found.empty()) << "ask mapping::finger_modes:\n" << lines(found);
}

}  // namespace
}  // namespace prehend
