#pragma once

#include <cstddef>
#include <string>

namespace prehend {

/// How far long work has come, on standard error: a bar that overwrites itself on a terminal, a
/// plain line each quarter elsewhere.
class Progress {
 public:
  explicit Progress(std::string what);
  /// The same number again says nothing.
  void show(std::size_t done, std::size_t all);

 private:
  std::string what_;
  bool terminal_;
  std::size_t shown_ = 0;  // quarters, or done + 1 on a terminal
};

}  // namespace prehend
