#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

#include "common/base/printable.hpp"

namespace prehend {

/// Prints for people to read, on standard output. Names of files, topics, objects and tasks are
/// somebody else's words: they cannot command the terminal from within it.
template <class... Values>
void to_terminal(fmt::format_string<Values...> format, Values&&... values) {
  const std::string text = printable(fmt::format(format, std::forward<Values>(values)...), "\n\t");
  std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace prehend
