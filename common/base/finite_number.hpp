#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace prehend {

// The one way in which numbers that people write are read, in any locale. Not-a-number passes every
// comparison with a bound, so it is no number here, nor is infinity.

/// The number that a word is, whole and finite. What is too small for a double, or all but, is 0.
std::optional<double> finite_number(std::string_view word);

/// All numbers of a text, between white space. None if a word is no finite number.
std::optional<std::vector<double>> finite_numbers(const std::string& text);

/// All numbers of a text between separators, as of «0.1,0.2». None if one is missing or no finite
/// number.
std::optional<std::vector<double>> finite_list(std::string_view text, char separator = ',');

/// What is wrong with a word that is no finite number, for messages: «5m is no number, write it
/// without a unit».
std::string no_finite_number(std::string_view word);

}  // namespace prehend
