#pragma once

#include <chrono>
#include <string>

namespace prehend::recorder {

/// One line on standard error that is renewed on a terminal; elsewhere a plain line now and then.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine() { clear(); }

  void show(const std::string& text);
  /// Makes room for other words.
  void clear();

 private:
  bool quiet_, terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace prehend::recorder
