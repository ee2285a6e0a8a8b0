#include "common/base/finite_number.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

#include "common/base/printable.hpp"

namespace prehend {
namespace {

/// from_chars says of 1e-400 and of 1e400 alike that they are out of range.
double beyond_range(std::string_view word) {
  std::istringstream stream{std::string(word)};
  stream.imbue(std::locale::classic());
  double value = std::numeric_limits<double>::infinity();
  return stream >> value ? value : std::numeric_limits<double>::infinity();
}

/// from_chars knows no plus, and after one it would take a minus.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

}  // namespace

std::optional<double> finite_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if (failure == std::errc::result_out_of_range)
    value = beyond_range(word);
  else if (failure != std::errc())
    return std::nullopt;
  if (!std::isfinite(value)) return std::nullopt;
  return std::abs(value) < std::numeric_limits<double>::min() ? 0 : value;
}

std::optional<std::vector<double>> finite_numbers(const std::string& text) {
  std::vector<double> found;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto number = finite_number(word);
    if (!number) return std::nullopt;
    found.push_back(*number);
  }
  return found;
}

std::optional<std::vector<double>> finite_list(std::string_view text, char separator) {
  std::vector<double> found;
  for (bool more = true; more;) {
    const std::size_t end = text.find(separator);
    std::string_view word = text.substr(0, end);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    const auto number = finite_number(word);
    if (!number) return std::nullopt;
    found.push_back(*number);
    more = end != std::string_view::npos;
    if (more) text.remove_prefix(end + 1);
  }
  return found;
}

std::string no_finite_number(std::string_view word) {
  if (word.empty()) return "is empty, a number is wanted";
  const std::string shown = printable(word);
  const std::string_view bare = without_plus(word);
  double value = 0;
  const auto [end, failure] = std::from_chars(bare.data(), bare.data() + bare.size(), value);
  if (end == bare.data() + bare.size() && failure != std::errc::invalid_argument)
    return shown + " is no finite number";
  if (end == bare.data()) return shown + " is no number";
  return shown + " is no number, write it without a unit";
}

}  // namespace prehend
