#pragma once

#include <string>

#include "common/stage/stage.hpp"

namespace prehend::cli {

/// How a play goes: one line that is renewed on a terminal; otherwise a line whenever there is
/// news, but not often.
class Screen {
 public:
  /// Of a quiet one nothing is seen, nor beside a log in JSON.
  explicit Screen(bool quiet);
  ~Screen() { clear(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void show(const std::string& text);
  void clear();
  /// For a stage; the screen must outlive it.
  stage::Progress progress() {
    return [this](const std::string& text) { show(text); };
  }

 private:
  bool quiet_, terminal_;
  std::string last_;
  std::chrono::steady_clock::time_point shown_{};
};

}  // namespace prehend::cli
