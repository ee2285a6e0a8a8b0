#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::service {

/// A setting of the lab: a number, a truth value, a text, or a list of numbers or of texts.
using Setting = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>>;

/// One key of lab.toml. All services share one table of keys (config_keys.cpp), so that a misspelt
/// key is an error everywhere, whoever reads it.
struct ConfigKey {
  std::string_view name;  // "table.key"
  Setting fallback;       // also fixes the type
  std::string_view help;
};
const std::vector<ConfigKey>& config_keys();

/// Variables of the environment that begin as those of keys do and mean something else.
const std::vector<std::string>& other_variables();

/// The configuration: defaults, then the file, then PREHEND_TABLE_KEY from the environment, then
/// overrides of the form "table.key=value". Unknown keys, wrong types and unknown variables
/// PREHEND_... are errors.
class Config {
 public:
  static Expected<Config> load(const std::filesystem::path& file,
                               const std::vector<std::string>& overrides = {});

  bool flag(std::string_view key) const;
  std::int64_t integer(std::string_view key) const;
  double number(std::string_view key) const;
  const std::string& text(std::string_view key) const;
  const std::vector<double>& numbers(std::string_view key) const;
  const std::vector<std::string>& names(std::string_view key) const;
  /// Has somebody set it? Else it has its default.
  bool is_given(std::string_view key) const;
  /// A path; a relative one is meant from the folder of the file, "share:x" from share_directory().
  /// Empty stays empty.
  std::filesystem::path path(std::string_view key) const;
  /// Every key with its value as the text of an override, so that another process, perhaps another
  /// day, can be given the same configuration. safety.deadman is there only where it was given: its
  /// default depends on the robot.
  std::map<std::string, std::string> texts() const;
  /// The same of the keys that the environment and overrides have set: in what a process differs
  /// from others with the same file.
  std::map<std::string, std::string> overridden() const;

 private:
  std::map<std::string, Setting, std::less<>> values_;
  std::set<std::string, std::less<>> given_, overridden_;
  std::filesystem::path directory_;
};

}  // namespace prehend::service
