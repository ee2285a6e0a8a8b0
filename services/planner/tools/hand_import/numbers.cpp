#include "services/planner/tools/hand_import/numbers.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

namespace prehend::planner {
namespace {

/// from_chars says of 1e-400 and of 1e400 alike that they are out of range.
double beyond_range(std::string_view word) {
  std::istringstream stream{std::string(word)};
  stream.imbue(std::locale::classic());
  double value = std::numeric_limits<double>::infinity();
  return stream >> value ? value : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<double> finite_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
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

}  // namespace prehend::planner
