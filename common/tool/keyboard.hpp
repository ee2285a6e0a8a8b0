#pragma once

#include <termios.h>

#include <optional>

namespace prehend::tool {

/// Keys as they are pressed, without waiting for Enter. The terminal is as before at the end.
class Keyboard {
 public:
  enum Key : int { up = 1000, down, right, left };

  /// Takes part only where standard input is a terminal.
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  /// False: nobody will ever press a key here.
  bool is_there() const { return before_.has_value(); }
  /// The next key that was pressed: a character or a Key.
  std::optional<int> key();

 private:
  std::optional<termios> before_;
};

}  // namespace prehend::tool
