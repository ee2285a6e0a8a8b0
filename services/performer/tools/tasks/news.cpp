#include "services/performer/tools/tasks/news.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace prehend::performer {

void show_news(const std::string& line) {
  static std::string last;
  if (line == last) return;
  last = line;
  if (::isatty(STDERR_FILENO))
    fmt::print(stderr, "\r\033[K{}", line.substr(0, 100));
  else
    fmt::print(stderr, "{}\n", line);
}

void end_news() {
  if (::isatty(STDERR_FILENO)) fmt::print(stderr, "\r\033[K");
}

}  // namespace prehend::performer
