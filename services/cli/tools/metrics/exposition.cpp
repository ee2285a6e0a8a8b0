#include "services/cli/tools/metrics/exposition.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/base/printable.hpp"

namespace prehend::cli {
namespace {

/// Somebody's text as it may stand in quotes there: without control characters, which is our wish,
/// and with what the format wants to be written differently.
std::string escaped(std::string_view text) {
  std::string made;
  for (const char c : printable(text, "\n")) {
    if (c == '\n')
      made += "\\n";
    else if (c == '\\' || c == '"')
      made += {'\\', c};
    else
      made += c;
  }
  return made;
}

std::string to_text(const Exposition::Labels& labels) {
  std::string text;
  for (const auto& [name, value] : labels)
    text += fmt::format("{}{}=\"{}\"", text.empty() ? "" : ",", name, escaped(value));
  return text.empty() ? text : "{" + text + "}";
}

std::string to_text(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);
}

}  // namespace

void Exposition::gauge(std::string_view name, std::string_view help) {
  families_.push_back({std::string(name), "gauge", std::string(help), {}, {}});
}

void Exposition::counter(std::string_view name, std::string_view help) {
  families_.push_back({std::string(name), "counter", std::string(help), {}, {}});
}

void Exposition::number(const Labels& labels, double value) {
  families_.back().numbers[to_text(labels)] = value;
}

void Exposition::count(const Labels& labels, std::uint64_t value) {
  families_.back().counts[to_text(labels)] += value;
}

std::string Exposition::text() const {
  std::string text;
  for (const Family& family : families_) {
    if (family.numbers.empty() && family.counts.empty()) continue;
    text += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", family.name, family.help, family.type);
    for (const auto& [labels, value] : family.numbers)
      text += fmt::format("{}{} {}\n", family.name, labels, to_text(value));
    for (const auto& [labels, value] : family.counts)
      text += fmt::format("{}{} {}\n", family.name, labels, value);
  }
  return text;
}

}  // namespace prehend::cli
