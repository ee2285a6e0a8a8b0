#include "common/tool/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

namespace prehend::tool {
namespace {

std::optional<char> waiting_byte() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char byte = 0;
  if (::poll(&input, 1, 0) != 1 || ::read(STDIN_FILENO, &byte, 1) != 1) return std::nullopt;
  return byte;
}

}  // namespace

Keyboard::Keyboard() {
  termios now{};
  // In the background the terminal belongs to somebody else.
  if (::isatty(STDIN_FILENO) == 0 || ::tcgetpgrp(STDIN_FILENO) != ::getpgrp() ||
      ::tcgetattr(STDIN_FILENO, &now) != 0)
    return;
  before_ = now;
  now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &now);
}

Keyboard::~Keyboard() {
  if (before_) ::tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

std::optional<int> Keyboard::key() {
  if (!before_) return std::nullopt;
  const auto first = waiting_byte();
  if (!first) return std::nullopt;
  if (*first != '\x1b') return *first;
  const auto second = waiting_byte();
  if (second != '[') return *first;
  const auto third = waiting_byte();
  if (third && *third >= 'A' && *third <= 'D') return up + (*third - 'A');
  return std::nullopt;
}

}  // namespace prehend::tool
