#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace prehend::planner {

/// The number that a word is, whole and finite, in any locale. What is too small for a double, or
/// all but, is 0.
std::optional<double> finite_number(std::string_view word);

/// All numbers of a text, between white space. None if a word is no finite number.
std::optional<std::vector<double>> finite_numbers(const std::string& text);

}  // namespace prehend::planner
