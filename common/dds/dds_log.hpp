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

}  // namespace prehend::dds
