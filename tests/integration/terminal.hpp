#pragma once

#include <sys/types.h>

#include <string>

#include "tests/integration/rig.hpp"

namespace prehend::integration {

/// A program on a terminal of its own; killed with it if it has not ended.
class Terminal {
 public:
  Terminal(const std::string& program, const Strings& arguments);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void press(const std::string& keys);
  /// Until it shows the text; what it showed before does not count again.
  bool shows(const std::string& text);
  /// Its exit code; -1: it did not end.
  int end();
  /// Letters appear as they are typed and wait for Enter, as in a shell.
  bool is_a_shells() const;
  const std::string& shown() const { return shown_; }

 private:
  void take();

  pid_t pid_ = -1;
  int descriptor_ = -1;
  bool ended_ = false;
  std::string shown_;
};

}  // namespace prehend::integration
