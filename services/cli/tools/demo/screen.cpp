#include "services/cli/tools/demo/screen.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "common/base/log_format.hpp"
#include "common/base/printable.hpp"
#include "common/base/terminal.hpp"

namespace prehend::cli {

Screen::Screen(bool quiet)
    : quiet_(quiet || log::format() == log::Format::json), terminal_(has_cursor(STDERR_FILENO)) {}

void Screen::show(const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (quiet_ || text == last_ ||
      now - shown_ < (terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(2)))
    return;
  last_ = text;
  shown_ = now;
  if (terminal_)
    fmt::print(stderr, "\r\033[K{}", printable(text.substr(0, 100)));
  else
    fmt::print(stderr, "{}\n", printable(text));
  std::fflush(stderr);
}

void Screen::clear() {
  if (!quiet_ && terminal_ && !last_.empty()) fmt::print(stderr, "\r\033[K");
  last_.clear();
}

}  // namespace prehend::cli
