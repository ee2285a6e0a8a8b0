#include "services/glove/devices/bird_capture.hpp"

#include <charconv>
#include <cmath>

namespace prehend::glove::bird {
namespace {

struct Line {
  double time = 0;
  bool command = false;
  std::string bytes;
};

template <class T>
bool parse(std::string_view& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool skip(std::string_view& text, std::string_view expected) {
  if (!text.starts_with(expected)) return false;
  text.remove_prefix(expected.size());
  return true;
}

void skip_blanks(std::string_view& text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
}

enum class Kind { conversation, comment, unreadable };

Kind read_line(std::string_view text, Line& line) {
  int number = 0;
  std::size_t length = 0;
  if (!parse(text, line.time) || !std::isfinite(line.time)) return Kind::unreadable;
  skip_blanks(text);
  if (!skip(text, ":")) return Kind::unreadable;
  skip_blanks(text);
  if (text.starts_with("(DEBUG)")) return Kind::comment;
  if (!skip(text, "(INFO)")) return Kind::unreadable;
  skip_blanks(text);
  if (!parse(text, number) || !skip(text, ". ")) return Kind::unreadable;
  line.command = skip(text, "command[");
  if (!line.command && !skip(text, "receive[")) return Kind::unreadable;
  if (!parse(text, length) || !skip(text, "] ")) return Kind::unreadable;
  // The bytes may end in blanks, so nothing is trimmed: the length must agree.
  const auto bytes = unescape(text);
  if (!bytes || bytes->size() != length) return Kind::unreadable;
  line.bytes = *bytes;
  return Kind::conversation;
}

/// Follows what is said on the line.
class Conversation {
 public:
  explicit Conversation(Capture& capture) : capture_(capture) {}

  void command(std::string_view bytes) {
    examined_.reset();
    const bool addressed = bytes.size() > 1 && static_cast<std::uint8_t>(bytes[0]) >= 0xF0u;
    if (addressed) bytes.remove_prefix(1);
    if (bytes.empty()) return;
    const auto argument = [&](std::size_t i) {
      return i < bytes.size() ? static_cast<std::uint8_t>(bytes[i]) : std::uint8_t{0};
    };
    Layout layout = parser_.layout();
    if (const auto format = format_of_command(bytes[0])) {
      layout.format = *format;
    } else if (bytes[0] == 'O') {
      examined_ = argument(1);
    } else if (bytes[0] == 'M') {
      layout.button = argument(1) != 0;
    } else if (bytes[0] == 'P' && argument(1) == group_mode) {
      layout.group = argument(2) != 0;
    } else if (bytes[0] == 'P' && argument(1) == position_scaling) {
      layout.range = argument(2) != 0 ? long_range : short_range;
    } else {
      return;
    }
    restart(layout);
  }

  void receive(double time, std::string_view bytes) {
    if (examined_) {
      if (*examined_ == position_scaling && bytes.size() == 2) {
        Layout layout = parser_.layout();
        layout.range = bytes[0] != 0 ? long_range : short_range;
        restart(layout);
      }
      if (*examined_ == group_mode && bytes.size() == 1) {
        Layout layout = parser_.layout();
        layout.group = bytes[0] != 0;
        restart(layout);
      }
      examined_.reset();
      return;
    }
    for (const Record& record : parser_.feed(bytes)) capture_.records.push_back({time, record});
  }

  void finish() { capture_.garbage += parser_.garbage() + parser_.pending(); }

 private:
  void restart(const Layout& layout) {
    capture_.garbage += parser_.garbage() + parser_.pending();
    parser_ = RecordParser(layout);
  }

  Capture& capture_;
  RecordParser parser_{Layout{}};
  std::optional<std::uint8_t> examined_;
};

}  // namespace

std::optional<std::string> unescape(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes.push_back(text[i]);
    } else if (i + 1 < text.size() && text[i + 1] == '\\') {
      bytes.push_back('\\');
      ++i;
    } else if (i + 3 < text.size() && text[i + 1] == 'x') {
      unsigned value = 0;
      const char* begin = text.data() + i + 2;
      const auto [end, error] = std::from_chars(begin, begin + 2, value, 16);
      if (error != std::errc() || end != begin + 2) return std::nullopt;
      bytes.push_back(static_cast<char>(value));
      i += 3;
    } else {
      return std::nullopt;
    }
  }
  return bytes;
}

Expected<Capture> read_capture(std::string_view text, std::string_view name) {
  Capture capture;
  Conversation conversation(capture);
  bool any = false;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view row = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (row.ends_with('\r')) row.remove_suffix(1);
    if (row.empty()) continue;
    Line line;
    const Kind kind = read_line(row, line);
    if (kind == Kind::unreadable) ++capture.unreadable_lines;
    if (kind != Kind::conversation) continue;
    any = true;
    if (line.command)
      conversation.command(line.bytes);
    else
      conversation.receive(line.time, line.bytes);
  }
  conversation.finish();
  if (!any)
    return fail("no line of a serial conversation in it", std::string(name),
                "give a capture with lines like `12.5 : (INFO) 1. command[1] B`");
  return capture;
}

}  // namespace prehend::glove::bird
