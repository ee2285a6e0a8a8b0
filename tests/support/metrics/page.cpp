#include "tests/support/metrics/page.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <regex>
#include <set>
#include <vector>

namespace prehend::tests {
namespace {

const std::regex family_name("[a-z][a-z0-9_]*");
const std::regex labels_form(
    R"re((?:[a-z_][a-z0-9_]*="(?:[^"\\\n]|\\\\|\\"|\\n)*"(?:,(?!$)|$))*)re");

struct Reader {
  MetricsPage page;
  std::string family;           // whose samples come now
  std::string helped;           // whose HELP came last
  std::set<std::string> ended;  // families that are over

  Expected<void> comment(std::string_view line);
  Expected<void> sample(std::string_view line);
};

Expected<void> Reader::comment(std::string_view line) {
  static const std::regex help("# HELP ([^ ]+) (?:[^\\\\\n]|\\\\\\\\|\\\\n)+");
  static const std::regex type("# TYPE ([^ ]+) (gauge|counter)");
  const std::string text(line);
  std::smatch match;
  if (std::regex_match(text, match, help)) {
    helped = match[1];
    return {};
  }
  if (!std::regex_match(text, match, type)) return fail("is neither HELP nor TYPE", text);
  if (helped != match[1]) return fail("has no HELP", text);
  if (!family.empty()) ended.insert(family);
  family = match[1];
  if (!std::regex_match(family, family_name)) return fail("is no name", text);
  if (ended.contains(family) || page.types.contains(family)) return fail("comes twice", text);
  if ((match[2] == "counter") != family.ends_with("_total"))
    return fail("a counter, and nothing else, is called _total", text);
  page.types[family] = match[2];
  return {};
}

Expected<void> Reader::sample(std::string_view line) {
  // The last space: one in a label is before the bracket.
  const std::size_t space = line.rfind(' ');
  if (space == std::string_view::npos) return fail("has no value", std::string(line));
  const std::string key(line.substr(0, space));
  const std::string_view number = line.substr(space + 1);
  const std::size_t bracket = key.find('{');
  if (key.substr(0, bracket) != family || page.types.empty())
    return fail("stands outside its family", key);
  if (bracket != std::string::npos) {
    if (key.back() != '}') return fail("is not closed", key);
    const std::string labels = key.substr(bracket + 1, key.size() - bracket - 2);
    if (!std::regex_match(labels, labels_form)) return fail("has wrong labels", key);
  }
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size())
    return fail("has no number", std::string(line));
  if (page.types[family] == "counter" && !(value >= 0)) return fail("counts below 0", key);
  if (!page.samples.emplace(key, value).second) return fail("is there twice", key);
  return {};
}

}  // namespace

Expected<MetricsPage> MetricsPage::parse(std::string_view text) {
  Reader reader;
  if (!text.empty() && text.back() != '\n') return fail("the last line does not end");
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(line.size() + 1);
    auto read = line.starts_with("#") ? reader.comment(line) : reader.sample(line);
    if (!read) return tl::unexpected(read.error());
  }
  return std::move(reader.page);
}

Expected<double> MetricsPage::value(std::string_view name, std::string_view labels) const {
  const double* found = nullptr;
  for (const auto& [key, number] : samples) {
    if (key.substr(0, key.find('{')) != name || key.find(labels) == std::string::npos) continue;
    if (found) return fail("several are so", fmt::format("{} {}", name, labels));
    found = &number;
  }
  if (!found) return fail("is not there", fmt::format("{} {}", name, labels));
  return *found;
}

std::string MetricsPage::shrunk_since(const MetricsPage& before) const {
  for (const auto& [key, number] : samples) {
    const auto type = types.find(key.substr(0, key.find('{')));
    if (type == types.end() || type->second != "counter") continue;
    const auto was = before.samples.find(key);
    if (was != before.samples.end() && was->second > number) return key;
  }
  return "";
}

}  // namespace prehend::tests
