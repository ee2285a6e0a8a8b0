#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// A device's side of its line as a value: what the host says in, what the device says out. Times
/// are those of any clock that does not run backwards.
class Emulator {
 public:
  virtual ~Emulator() = default;

  /// Answers to bytes that come at `now`.
  virtual std::string receive(std::string_view bytes, Duration now) = 0;

  /// A new measurement, and the records that are sent because of it, one by one: what a datagram
  /// or a unit of a tracker says. Records that wait to be asked for are not among them.
  virtual std::vector<std::string> measure(const Frame& frame, Duration now) = 0;
};

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

}  // namespace prehend::glove
