#pragma once

#include <string>
#include <string_view>

#include "common/base/time.hpp"

namespace prehend::serial {

/// The far end of a line: where an emulated device is plugged in.
class Plug {
 public:
  virtual ~Plug() = default;
  /// What the host wrote; waits for it at most that long.
  virtual std::string read(Duration timeout) = 0;
  /// Bytes, or one datagram. What finds no room, because nobody reads, is lost.
  virtual void write(std::string_view bytes) = 0;
  /// Where the host finds it: a path, or host and port.
  virtual std::string where() const = 0;
};

}  // namespace prehend::serial
