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

}  // namespace prehend::glove
