#include "common/base/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <utility>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/printable.hpp"
#include "common/base/terminal.hpp"

namespace prehend {
namespace {

constexpr std::size_t width = 30;  // characters of the bar

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)),
      terminal_(has_cursor(STDERR_FILENO) && log::format() == log::Format::text) {}

void Progress::show(std::size_t done, std::size_t all) {
  if (all == 0) return;
  if (terminal_) {
    if (done + 1 == shown_) return;
    shown_ = done + 1;
    fmt::print(stderr, "\r{:<32} [{:<{}}] {:>4} of {}{}", printable(what_),
               std::string(width * done / all, '#'), width, done, all, done >= all ? "\n" : "");
    return;
  }
  const std::size_t quarter = 4 * done / all;
  if (quarter == shown_) return;
  shown_ = quarter;
  log::info("{}: {} of {}", what_, done, all);
}

}  // namespace prehend
