#include "services/glove/devices/bird_words.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "services/glove/devices/bird_protocol.hpp"

namespace prehend::glove::bird {

std::string_view error_in_words(std::uint8_t code) {
  // 20 to 27 are faults of the processor itself.
  static constexpr std::array<std::string_view, 36> words{
      "no error",
      "its memory is faulty",
      "its settings cannot be stored",
      "the data of its circuit board are corrupt",
      "the transmitter is missing, or its data are corrupt",
      "a sensor is missing, or its data are corrupt",
      "it did not understand a command",
      "the unit asked is not the master",
      "no unit of the flock can be reached",
      "a unit has not been initialised",
      "garbled bytes between its units",
      "garbled or lost bytes from the host",
      "garbled bytes on the bus",
      "a unit does not answer",
      "a unit did not understand a command on the bus",
      "the bus failed while running",
      "its processor has the wrong speed",
      "a unit sends no data",
      "the baud rate is not allowed",
      "a unit does not acknowledge",
      "its processor failed",
      "its processor failed",
      "its processor failed",
      "its processor failed",
      "its processor failed",
      "its processor failed",
      "its processor failed",
      "its processor failed",
      "it cannot follow the screen's synchronisation",
      "the transmitter cannot be reached",
      "the extended range transmitter is not attached",
      "it has no time left for its computations",
      "a sensor is saturated: too close to the transmitter",
      "a unit is set up wrongly",
      "its watchdog has struck",
      "it is too hot"};
  return code < words.size() ? words[code] : "an unknown error";
}

std::string status_in_words(std::uint16_t status) {
  std::vector<std::string_view> words;
  const auto bit = [&](int n) { return (status >> n & 1) != 0; };
  if (bit(15)) words.push_back("master");
  words.push_back(bit(14) ? "initialised" : "not initialised");
  if (bit(13)) words.push_back("an error is waiting");
  words.push_back(bit(12) ? "running" : "not running");
  if (bit(5)) words.push_back("asleep");
  // 1 to 8: position, angles, matrix, position and angles, position and matrix, (unused),
  // quaternion, position and quaternion.
  constexpr std::array<int, 9> order{-1, 0, 1, 2, 4, 5, -1, 3, 6};
  const auto output = static_cast<std::size_t>(status >> 1 & 0xf);
  if (output < order.size() && order[output] >= 0)
    words.push_back(formats[static_cast<std::size_t>(order[output])].name);
  words.push_back(bit(0) ? "stream" : "point");
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string revision_in_words(std::string_view bytes) {
  if (bytes.size() != 2) return "unknown";
  return fmt::format("{}.{:02}", static_cast<std::uint8_t>(bytes[0]),
                     static_cast<std::uint8_t>(bytes[1]));
}

}  // namespace prehend::glove::bird
