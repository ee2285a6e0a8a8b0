#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "services/glove/devices/bird_protocol.hpp"

namespace prehend::glove::bird {

struct CapturedRecord {
  double time = 0;  // s, as written in the capture
  Record record;
};

/// What a capture holds. Bytes that form no record are counted.
struct Capture {
  std::vector<CapturedRecord> records;
  std::uint64_t garbage = 0;
  std::size_t unreadable_lines = 0;
};

/// Reads the text of a serial conversation, lines of the form
///   `<seconds> : (INFO) <n>. command[<length>] <bytes>` and `… receive[<length>] <bytes>`
/// with unprintable bytes as \xHH and backslashes doubled. The commands tell how to read the
/// records: format, buttons, group mode, range. Fails if no line is of that form.
Expected<Capture> read_capture(std::string_view text, std::string_view name);

/// Bytes of an escaped text; nothing if an escape is broken.
std::optional<std::string> unescape(std::string_view text);

}  // namespace prehend::glove::bird
