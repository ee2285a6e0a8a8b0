#pragma once

#include <string>

namespace prehend::dds {

/// What Fast DDS has to say. It would print it on standard output, which belongs to --json.
class DdsLog {
 public:
  /// From now on it goes to our log: each kind of complaint once, then not for ten seconds, so that
  /// a flood of bad packets does not become a flood of lines.
  static void install();

  /// Collects the complaints of one category instead, for as long as it lives. One at a time.
  class Capture {
   public:
    explicit Capture(std::string category);
    ~Capture();
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;
    /// All that has been said so far, in one line; empty when nothing has.
    std::string text() const;
  };
};

/// Fast DDS 3.1.2 keeps the last message of a handshake with each peer that left before its end,
/// for good, and has room for a hundred: then it shakes hands with nobody new. True once it has
/// said so. Who joins anew has room again.
bool handshakes_are_used_up();

}  // namespace prehend::dds
