#pragma once

#include <string_view>
#include <vector>

namespace prehend::architecture {

/// A letter, a digit or «_».
bool is_word_character(char c);

/// An identifier in a line of code.
struct Word {
  std::string_view text;
  std::string_view before, after;  // the rest of the line
};

std::vector<Word> identifiers(std::string_view line);

}  // namespace prehend::architecture
