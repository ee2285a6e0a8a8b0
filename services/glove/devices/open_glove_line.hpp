#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/human_hand.hpp"

/// What open gloves (LucidGloves) and their hosts say to each other, as the firmware of 2025-10 and
/// its drivers have it; we had no glove to check it with. 115,200 baud, 8N1, text, a line each way:
///
///   A0B2047C4095D0E12F2048G2048P0LM      glove: fingers, thumb first, 0 to 4095; stick, trigger;
///                                        letters of the buttons that are pressed
///   A500B0C0D0E1000                      host: how far each finger is held back, 0 to 1000
///
/// Lines have at most 100 characters. A glove waits for a line after each of its own.
namespace prehend::glove::open_glove {

inline constexpr int full = 4095;             // of a finger; a small processor sends up to 1023
inline constexpr std::size_t max_line = 100;  // characters
inline constexpr std::uint8_t buttons = 6;    // A, B, trigger, stick, menu, calibrate: 1 to 6

struct Sample {
  std::array<int, model::finger_count> fingers{};  // thumb first
  std::vector<std::uint8_t> held;                  // buttons; gestures that the glove sees are none
};

/// Nothing: a finger or the stick is missing, twice there or out of range, or something in it is
/// not known. What a host says has no stick, so that its echo is no glove.
std::optional<Sample> parse(std::string_view line);

/// What the host says: how far each finger is held back, 0 not at all, 1 so that it cannot bend.
using HeldBack = std::array<double, model::finger_count>;
std::string to_line(const HeldBack& shares);
/// The same read by a glove. Nothing: a finger is missing, twice there or out of range.
std::optional<HeldBack> parse_held_back(std::string_view line);

/// With its line end.
std::string to_line(const Sample& sample);

/// Cuts a stream into lines; of what is longer than a line may be nothing is kept.
class LineParser {
 public:
  std::vector<std::string> feed(std::string_view bytes);
  /// Lines that were too long, since the last call.
  std::uint64_t take_overlong();

 private:
  std::string pending_;
  bool lost_ = false;
  std::uint64_t overlong_ = 0;
};

}  // namespace prehend::glove::open_glove
