#include "services/robot/core/barrett_protocol.hpp"

#include <charconv>
#include <cmath>
#include <numbers>

namespace prehend::robot::barrett {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t spread = 3;
/// Encoders overshoot the stops a little, and count from where homing pressed against them.
constexpr int slack = 700;
constexpr double coldest = -20, hottest = 125;  // °C, of any hand

int byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

}  // namespace

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < line.size();) {
    while (at < line.size() && is_space(line[at])) ++at;
    const std::size_t begin = at;
    while (at < line.size() && !is_space(line[at])) ++at;
    if (at > begin) words.emplace_back(line.substr(begin, at - begin));
  }
  return words;
}

std::optional<int> number_of(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

double counts_per_radian(std::size_t motor) {
  return motor == spread ? spread_counts / pi : finger_counts / (140 * pi / 180);
}

int max_counts(std::size_t motor) {
  return motor == spread ? spread_counts : finger_counts;
}

std::string explain(int status) {
  struct Meaning {
    int bit;
    const char* text;
  };
  static constexpr Meaning meanings[] = {{1, "no motor board"},
                                         {2, "no motor"},
                                         {not_initialized, "motor not initialized"},
                                         {position_not_reached, "position not reached"},
                                         {unknown_command, "unknown command"},
                                         {unknown_parameter, "unknown parameter"},
                                         {invalid_value, "invalid value"},
                                         {read_only, "read-only parameter"},
                                         {too_many_arguments, "too many arguments"},
                                         {invalid_header, "invalid control block"},
                                         {no_motor_prefix, "command takes no motors"},
                                         {over_temperature, "too hot"},
                                         {aborted, "aborted"}};
  std::string text;
  int rest = status;
  for (const Meaning& meaning : meanings)
    if ((status & meaning.bit) != 0) {
      text += (text.empty() ? "" : ", ") + std::string(meaning.text);
      rest &= ~meaning.bit;
    }
  if (rest != 0 || text.empty()) text += (text.empty() ? "" : ", ") + std::string("unknown fault");
  return text + " (" + std::to_string(status) + ")";
}

Reply parse_reply(std::string_view text) {
  Reply reply;
  std::string line;
  const auto end_line = [&] {
    const auto words = words_of(line);
    if (words.size() >= 2 && words[0] == "ERR")
      reply.error |= number_of(words[1]).value_or(0);
    else if (!words.empty())
      reply.lines.push_back(line);
    line.clear();
  };
  for (const char c : text) {
    if (c == '\r' || c == '\n')
      end_line();
    else if (c >= ' ' && c <= '~')
      line += c;
  }
  end_line();
  return reply;
}

std::optional<std::vector<int>> numbers(const Reply& reply) {
  std::vector<int> found;
  for (const std::string& line : reply.lines)
    for (const std::string& word : words_of(line)) {
      const auto number = number_of(word);
      if (!number) return std::nullopt;
      found.push_back(*number);
    }
  return found;
}

std::optional<unsigned> motors_of(std::string_view prefix) {
  if (prefix.empty()) return 0b1111u;
  unsigned named = 0;
  for (const char c : prefix) {
    if (c >= '1' && c <= '4')
      named |= 1u << static_cast<unsigned>(c - '1');
    else if (c == 'S')
      named |= 0b1000u;
    else if (c == 'G')
      named |= 0b0111u;
    else
      return std::nullopt;
  }
  return named;
}

std::size_t feedback_size(int temperature_bytes) {
  return motors * motor_bytes + static_cast<std::size_t>(temperature_bytes);
}

std::optional<Feedback> decode(std::string_view bytes, int temperature_bytes) {
  if (temperature_bytes < 0 || temperature_bytes > 2 ||
      bytes.size() != feedback_size(temperature_bytes))
    return std::nullopt;
  Feedback feedback;
  for (std::size_t i = 0; i < motors; ++i) {
    feedback.strain[i] = byte_at(bytes, i * motor_bytes);
    // Before the open stop the unsigned word wraps.
    const int word = byte_at(bytes, i * motor_bytes + 1) << 8 | byte_at(bytes, i * motor_bytes + 2);
    feedback.position[i] = word >= 0x8000 ? word - 0x10000 : word;
    if (feedback.position[i] < -slack || feedback.position[i] > max_counts(i) + slack)
      return std::nullopt;
  }
  const std::size_t at = motors * motor_bytes;
  if (temperature_bytes == 1) feedback.temperature = byte_at(bytes, at);
  if (temperature_bytes == 2)
    feedback.temperature =
        static_cast<std::int16_t>(byte_at(bytes, at) << 8 | byte_at(bytes, at + 1)) / 10.0;
  if (feedback.temperature && (*feedback.temperature < coldest || *feedback.temperature > hottest))
    return std::nullopt;
  return feedback;
}

std::string control_block(const std::array<std::int8_t, motors>& velocity) {
  std::string block = "C";
  for (const std::int8_t v : velocity) block += static_cast<char>(v == end_of_line ? v - 1 : v);
  return block;
}

}  // namespace prehend::robot::barrett
