#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace prehend::fuzz {

/// What two sides said, turn by turn, as one input: so it is played at the pace at which it was
/// spoken. Each part stands behind its length, two bytes, the lower one first.
inline void add_turn(std::string& input, std::string_view said) {
  const std::size_t size = std::min<std::size_t>(said.size(), 0xffff);
  input += static_cast<char>(size & 0xff);
  input += static_cast<char>(size >> 8);
  input += said.substr(0, size);
}

/// The turns of an input, whatever it is; the last one may be shorter than it says.
inline std::vector<std::string_view> turns_of(std::string_view input) {
  std::vector<std::string_view> turns;
  while (input.size() >= 2) {
    const auto byte = [&](std::size_t i) {
      return static_cast<std::size_t>(static_cast<unsigned char>(input[i]));
    };
    const std::size_t size = std::min(byte(0) | byte(1) << 8, input.size() - 2);
    turns.push_back(input.substr(2, size));
    input.remove_prefix(2 + size);
  }
  return turns;
}

}  // namespace prehend::fuzz
