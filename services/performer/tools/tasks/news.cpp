#include "services/performer/tools/tasks/news.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "common/base/printable.hpp"
#include "common/base/terminal.hpp"

namespace prehend::performer {

void show_news(const std::string& line) {
  static std::string last;
  if (line == last) return;
  last = line;
  if (has_cursor(STDERR_FILENO))
    fmt::print(stderr, "\r\033[K{}", printable(line.substr(0, 100)));
  else
    fmt::print(stderr, "{}\n", printable(line));
}

void end_news() {
  if (has_cursor(STDERR_FILENO)) fmt::print(stderr, "\r\033[K");
}

}  // namespace prehend::performer
