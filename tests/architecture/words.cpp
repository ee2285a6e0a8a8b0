#include "tests/architecture/words.hpp"

#include <cctype>

namespace prehend::architecture {

bool is_word_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

std::vector<Word> identifiers(std::string_view line) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < line.size();) {
    if (!is_word_character(line[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < line.size() && is_word_character(line[end])) ++end;
    words.push_back({line.substr(i, end - i), line.substr(0, i), line.substr(end)});
    i = end;
  }
  return words;
}

}  // namespace prehend::architecture
