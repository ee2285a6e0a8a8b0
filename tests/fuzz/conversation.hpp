#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/base/time.hpp"
#include "tests/fuzz/fuzz.hpp"

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

/// What a driver and its robot say to each other in so many turns; before each the driver may be
/// led.
template <class Robot, class Driver>
std::string converse(
    Robot robot, Driver driver, int turns, Duration turn,
    const std::function<void(std::type_identity_t<Driver>&, int, Time)>& lead = {}) {
  std::string all, heard;
  driver.connected(from_ns(0));
  for (int n = 0; n < turns; ++n) {
    const Time now = from_ns(0) + turn * n;
    if (lead) lead(driver, n, now);
    const std::string said = driver.step(heard, now);
    add_turn(all, heard);
    add_turn(all, said);
    heard = robot.receive(said, turn * n);
  }
  return all;
}

/// What a parser finds is found again when it is sent on.
template <class Parser, class Encode>
void require_whole(const Parser& parser, const std::string& input, const Encode& encode) {
  Parser first = parser;
  first.feed(input);
  while (const auto frame = first.next()) {
    Parser again = parser;
    again.feed(encode(*frame));
    require(again.next() == frame, "is another frame when it is sent on");
  }
}

}  // namespace prehend::fuzz
