#include "services/glove/devices/open_glove_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace prehend::glove::open_glove {
namespace {

constexpr std::string_view numbers = "ABCDEFGP";  // fingers, stick, trigger
constexpr int held_full = 1000;
constexpr std::size_t needed = 7;  // all but the trigger
constexpr std::string_view button_letters = "JKIHNO";
constexpr std::string_view gesture_letters = "LM";  // the glove's own opinion of the fingers

/// The number at the front of the text, and the text behind it.
std::optional<int> take_number(std::string_view& text) {
  int value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc{} || value < 0 || value > full) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// (AB)12, splay and joints that this glove measures beside: passed over. False: it is damaged.
bool pass_by(std::string_view& text) {
  const std::size_t end = text.find(')');
  if (end == std::string_view::npos || end > 4) return false;
  text.remove_prefix(end + 1);
  return take_number(text).has_value();
}

}  // namespace

std::optional<Sample> parse(std::string_view text) {
  Sample sample;
  std::array<bool, numbers.size()> seen{};
  while (!text.empty()) {
    const char letter = text.front();
    if (letter == '(') {
      if (!pass_by(text)) return std::nullopt;
      continue;
    }
    text.remove_prefix(1);
    const auto number = numbers.find(letter);
    const auto button = button_letters.find(letter);
    if (number != std::string_view::npos) {
      const auto value = take_number(text);
      if (!value || std::exchange(seen[number], true)) return std::nullopt;
      if (number < sample.fingers.size()) sample.fingers[number] = *value;
    } else if (button != std::string_view::npos) {
      sample.held.push_back(static_cast<std::uint8_t>(button + 1));
    } else if (letter == 'Z') {
      (void)take_number(text);
    } else if (gesture_letters.find(letter) == std::string_view::npos && letter != '\r') {
      return std::nullopt;
    }
  }
  std::ranges::sort(sample.held);
  if (std::ranges::adjacent_find(sample.held) != sample.held.end()) return std::nullopt;
  const bool whole = std::all_of(seen.begin(), seen.begin() + needed, [](bool one) { return one; });
  return whole ? std::optional(sample) : std::nullopt;
}

std::string to_line(const Sample& sample) {
  std::string line;
  for (std::size_t f = 0; f < sample.fingers.size(); ++f)
    line += fmt::format("{}{}", numbers[f], std::clamp(sample.fingers[f], 0, full));
  line += "F2048G2048P0";
  for (const std::uint8_t button : sample.held)
    if (button >= 1 && button <= buttons) line += button_letters[button - 1U];
  return line + "\n";
}

std::string to_line(const HeldBack& shares) {
  std::string line;
  for (std::size_t f = 0; f < shares.size(); ++f)
    line +=
        fmt::format("{}{}", numbers[f], std::lround(held_full * std::clamp(shares[f], 0.0, 1.0)));
  return line + "\n";
}

std::optional<HeldBack> parse_held_back(std::string_view text) {
  HeldBack shares{};
  std::array<bool, model::finger_count> seen{};
  while (!text.empty()) {
    const auto finger = numbers.find(text.front());
    text.remove_prefix(1);
    if (finger >= shares.size() || std::exchange(seen[finger], true)) return std::nullopt;
    const auto value = take_number(text);
    if (!value || *value > held_full) return std::nullopt;
    shares[finger] = static_cast<double>(*value) / held_full;
  }
  return std::ranges::all_of(seen, [](bool one) { return one; }) ? std::optional(shares)
                                                                 : std::nullopt;
}

std::vector<std::string> LineParser::feed(std::string_view bytes) {
  std::vector<std::string> lines;
  for (const char byte : bytes) {
    if (byte == '\n') {
      if (!std::exchange(lost_, false) && !pending_.empty()) lines.push_back(pending_);
      pending_.clear();
    } else if (pending_.size() < max_line) {
      pending_ += byte;
    } else if (!std::exchange(lost_, true)) {
      ++overlong_;
    }
  }
  return lines;
}

std::uint64_t LineParser::take_overlong() {
  return std::exchange(overlong_, 0);
}

}  // namespace prehend::glove::open_glove
