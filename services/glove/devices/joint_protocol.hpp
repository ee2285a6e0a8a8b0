#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The serial protocol of CyberGlove-class gloves, as public drivers and their documentation have
/// it (ROS cyberglove, libglove, asr_cyberglove_lib); we had no glove to check it with, so all of
/// it is an assumption of ours.
///
/// 115,200 baud, 8N1. A sample is the byte 'S' (streamed) or 'G' (asked for), one byte a sensor
/// from 1 to 255, and a 0; so a 0 is the end of a record and nothing else. Commands used:
///   "?S" answers "?S", the number of sensors, 0; "?R" answers "?R", 1 for a right hand's glove, 0
///   "u 0\r" no status byte in records; "t W 1\r" a sample every W/115200 s; answers are text
///   "S" streams, "G" asks for one; the byte 3 (Ctrl-C) ends streaming
/// A command that is not understood answers "e?", 0.
namespace prehend::glove::joint {

inline constexpr double ticks = 115200;  // a second, in which periods are given

/// Counts of all sensors, 1 to 255.
using Counts = std::vector<std::uint8_t>;

/// The bytes of a sample; 0 in counts becomes 1.
std::string encode(const Counts& counts, char kind = 'S');

/// Cuts a stream into samples of so many sensors. The next 0 is where it finds its place again.
class RecordParser {
 public:
  explicit RecordParser(std::size_t sensors) : sensors_(sensors) {}

  std::vector<Counts> feed(std::string_view bytes);
  /// Bytes that belonged to no sample.
  std::uint64_t garbage() const { return garbage_; }
  /// Bytes of a record that is not complete yet.
  std::size_t pending() const { return pending_.size(); }

 private:
  std::size_t sensors_;
  std::string pending_;
  bool lost_ = false;  // more has come than a record holds
  std::uint64_t garbage_ = 0;
};

/// "t W 1\r" for a rate, Hz.
std::string period_command(double rate);

/// The value in the answer to "?S" or "?R", if that is what the bytes end with.
std::optional<std::uint8_t> answered(char name, std::string_view bytes);

}  // namespace prehend::glove::joint
