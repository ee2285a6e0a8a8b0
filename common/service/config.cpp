#include "common/service/config.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <optional>

#include "common/base/paths.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::service {
namespace {

const ConfigKey* find_key(std::string_view name) {
  const auto& keys = config_keys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const ConfigKey& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

std::string_view type_name(const Setting& setting) {
  constexpr std::string_view names[] = {
      "true or false", "a whole number",           "a finite number",
      "a text",        "a list of finite numbers", "a list of texts"};
  return names[setting.index()];
}

template <class T>
std::optional<std::vector<T>> list(const toml::node& node) {
  const toml::array* array = node.as_array();
  if (!array) return std::nullopt;
  std::vector<T> entries;
  for (const toml::node& entry : *array) {
    const auto value = entry.value<T>();
    if (!value) return std::nullopt;
    entries.push_back(*value);
  }
  return entries;
}

/// The node as a value of the same type as `like`, or nothing.
std::optional<Setting> convert(const toml::node& node, const Setting& like) {
  if (std::holds_alternative<bool>(like)) {
    if (node.is_boolean()) return Setting(**node.as_boolean());
  } else if (std::holds_alternative<std::int64_t>(like)) {
    if (node.is_integer()) return Setting(**node.as_integer());
  } else if (std::holds_alternative<double>(like)) {
    if (const auto number = node.value<double>(); number && node.is_number())
      return Setting(*number);
  } else if (std::holds_alternative<std::string>(like)) {
    if (node.is_string()) return Setting(**node.as_string());
  } else if (std::holds_alternative<std::vector<double>>(like)) {
    if (auto numbers = list<double>(node)) return Setting(std::move(*numbers));
  } else if (auto texts = list<std::string>(node)) {
    return Setting(std::move(*texts));
  }
  return std::nullopt;
}

/// In single letters put in, left out or changed.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j - 1] + 1, above + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row.back();
}

/// The nearest known name, to help with a slip of the pen.
std::string suggestion(std::string_view unknown, const std::vector<std::string>& known) {
  const auto nearest =
      std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
        return distance(unknown, a) < distance(unknown, b);
      });
  return fmt::format("did you mean {}?", *nearest);
}

std::string nearest_key(std::string_view unknown) {
  std::vector<std::string> names;
  for (const ConfigKey& key : config_keys()) names.emplace_back(key.name);
  return suggestion(unknown, names);
}

std::string variable_of(const ConfigKey& key) {
  std::string variable = "PREHEND_" + std::string(key.name);
  for (char& c : variable)
    c = c == '.' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return variable;
}

/// A misspelt variable would be passed over, and what it should have switched on stay off.
Expected<void> check_environment() {
  std::vector<std::string> known = other_variables();
  for (const ConfigKey& key : config_keys()) known.push_back(variable_of(key));
  for (char** entry = environ; *entry; ++entry) {
    std::string name = *entry;
    name.resize(std::min(name.find('='), name.size()));
    if (name.starts_with("PREHEND_") && std::find(known.begin(), known.end(), name) == known.end())
      return fail("unknown variable of the environment", name, suggestion(name, known));
  }
  return {};
}

}  // namespace

namespace {

/// Where values go, and the names of those that were given.
struct Values {
  std::map<std::string, Setting, std::less<>>& values;
  std::set<std::string, std::less<>>& given;
};

Expected<void> set(const Values& values, std::string_view name, const toml::node& node,
                   const std::string& where) {
  const ConfigKey* key = find_key(name);
  if (!key) return fail(fmt::format("unknown key {}", name), where, nearest_key(name));
  auto value = convert(node, key->fallback);
  if (!value)
    return fail(fmt::format("{} must be {}", name, type_name(key->fallback)), where,
                std::string(key->help));
  values.values.find(name)->second = std::move(*value);
  values.given.emplace(name);
  return {};
}

/// A value as it stands behind a key in TOML; bare words are texts.
Expected<void> set_from_text(const Values& values, std::string_view name, const std::string& text,
                             const std::string& where) {
  const ConfigKey* key = find_key(name);
  if (!key) return fail(fmt::format("unknown key {}", name), where, nearest_key(name));
  if (std::holds_alternative<std::string>(key->fallback))
    return set(values, name, toml::value<std::string>(text), where);
  const auto table = parse_toml("value = " + text, where);
  if (table && table->size() == 1) return set(values, name, *table->get("value"), where);
  return fail(fmt::format("{} must be {}", name, type_name(key->fallback)), where,
              std::string(key->help));
}

Expected<void> set_from_file(const Values& values, const std::filesystem::path& file) {
  const auto place = [&](const toml::node& node) {
    return fmt::format("{}: line {}", file.string(), node.source().begin.line);
  };
  const auto root = load_toml(file, "the configuration is a TOML file");
  if (!root) return tl::unexpected(root.error());
  for (const auto& [table_name, node] : *root) {
    const toml::table* table = node.as_table();
    if (!table)
      return fail(fmt::format("unknown key {}", table_name.str()), file.string(),
                  "keys stand in tables");
    for (const auto& [key, value] : *table) {
      const std::string name = fmt::format("{}.{}", table_name.str(), key.str());
      if (const auto done = set(values, name, value, place(value)); !done) return done;
    }
  }
  return {};
}

Expected<void> set_from_environment(const Values& values) {
  for (const ConfigKey& key : config_keys()) {
    const std::string variable = variable_of(key);
    if (const char* text = std::getenv(variable.c_str()))
      if (const auto done = set_from_text(values, key.name, text, variable); !done) return done;
  }
  return {};
}

/// text: «table.key=value».
Expected<void> set_from_override(const Values& values, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return fail("must be table.key=value", "--set " + text);
  return set_from_text(values, text.substr(0, equals), text.substr(equals + 1), "--set " + text);
}

}  // namespace

Expected<Config> Config::load(const std::filesystem::path& file,
                              const std::vector<std::string>& overrides) {
  Config config;
  std::error_code nowhere;  // a file without a name is refused when it is read
  config.directory_ = std::filesystem::absolute(file, nowhere).parent_path();
  for (const ConfigKey& key : config_keys()) config.values_.emplace(key.name, key.fallback);
  const Values values{config.values_, config.given_};
  auto done = check_environment();
  if (done) done = set_from_file(values, file);
  const Values over{config.values_, config.overridden_};
  if (done) done = set_from_environment(over);
  for (const std::string& text : overrides)
    if (done) done = set_from_override(over, text);
  config.given_.insert(config.overridden_.begin(), config.overridden_.end());
  if (!done) return tl::unexpected(done.error());
  return config;
}

namespace {
template <class T>
const T& get(const std::map<std::string, Setting, std::less<>>& values, std::string_view key) {
  return std::get<T>(values.find(key)->second);
}
}  // namespace

bool Config::is_given(std::string_view key) const {
  return given_.contains(key);
}
bool Config::flag(std::string_view key) const {
  return get<bool>(values_, key);
}
std::int64_t Config::integer(std::string_view key) const {
  return get<std::int64_t>(values_, key);
}
double Config::number(std::string_view key) const {
  return get<double>(values_, key);
}
const std::string& Config::text(std::string_view key) const {
  return get<std::string>(values_, key);
}
const std::vector<double>& Config::numbers(std::string_view key) const {
  return get<std::vector<double>>(values_, key);
}
const std::vector<std::string>& Config::names(std::string_view key) const {
  return get<std::vector<std::string>>(values_, key);
}

std::filesystem::path Config::path(std::string_view key) const {
  const std::string& given = text(key);
  if (given.empty()) return {};
  if (given.starts_with("share:")) return share_directory() / given.substr(6);
  const std::filesystem::path path(given);
  return path.is_absolute() ? path : directory_ / path;
}

namespace {

std::string to_text(const Setting& setting) {
  struct ToText {
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const { return fmt::format("{}", value); }
    std::string operator()(const std::string& value) const { return value; }
    std::string operator()(const std::vector<double>& value) const {
      return fmt::format("[{}]", fmt::join(value, ", "));
    }
    std::string operator()(const std::vector<std::string>& value) const {
      return value.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(value, "\", \""));
    }
  };
  return std::visit(ToText{}, setting);
}

}  // namespace

std::map<std::string, std::string> Config::texts() const {
  std::map<std::string, std::string> texts;
  for (const auto& [key, value] : values_)
    if (key != "safety.deadman" || is_given(key)) texts.emplace(key, to_text(value));
  return texts;
}

std::map<std::string, std::string> Config::overridden() const {
  std::map<std::string, std::string> texts;
  for (const auto& key : overridden_) texts.emplace(key, to_text(values_.find(key)->second));
  return texts;
}

}  // namespace prehend::service
