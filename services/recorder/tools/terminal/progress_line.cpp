#include "services/recorder/tools/terminal/progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "common/base/log_format.hpp"
#include "common/base/printable.hpp"
#include "common/base/terminal.hpp"

namespace prehend::recorder {

ProgressLine::ProgressLine(bool quiet)
    : quiet_(quiet || log::format() == log::Format::json), terminal_(has_cursor(STDERR_FILENO)) {}

void ProgressLine::show(const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10'000));
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\033[K" : "", printable(text), terminal_ ? "" : "\n");
  std::fflush(stderr);
  shown_ = terminal_;
}

void ProgressLine::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace prehend::recorder
