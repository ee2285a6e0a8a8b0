#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend::serial {

/// Who seems to speak at a port where a device did not answer as it does.
enum class Speaker {
  ourselves,   // what we said comes back
  satellites,  // a GPS receiver tells where it is, unasked (NMEA 0183)
  text,        // something that greets, complains or prompts
  bytes        // no text: another baud rate, or a device that speaks in bytes
};

/// Remembers the end of what was heard and of what was said.
class Overheard {
 public:
  void heard(std::string_view bytes) { keep(heard_, bytes, 256); }
  void said(std::string_view bytes) { keep(said_, bytes, 1024); }

  /// Nothing: it was silent.
  std::optional<Speaker> speaker() const;
  /// The error of a device that did not answer as it does. What was heard instead is quoted, and
  /// the hint says what to do about that; `silence` is the error if nothing was.
  Error unanswered(Error silence) const;

 private:
  static void keep(std::string& all, std::string_view bytes, std::size_t size);

  std::string heard_, said_;
};

/// Whether a message says something else than the one before, what they quote aside: that may be
/// different each time. A first quote without a letter or digit was the end of some words; those
/// are news.
bool is_news(std::string_view message, std::string_view before);

}  // namespace prehend::serial
