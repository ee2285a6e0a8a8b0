#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/architecture/house.hpp"

namespace prehend::architecture {

struct Line {
  int number = 0;
  const std::string* text = nullptr;  // in the page, which lives longer
};

/// The lines of a page that stand in no fenced block.
std::vector<Line> prose_of(const File& page);

bool is_heading(std::string_view line);

/// What #... of a link to each heading of a page is, as GitHub makes it: small letters, hyphens for
/// blanks, no punctuation; of equal ones the second has -1 at its end.
std::vector<std::string> slugs_of(const File& page);

/// A word has a letter or a digit; the bars of a table have none.
int words_in(std::string_view text);

}  // namespace prehend::architecture
