#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// DYNAMIXEL protocol 2.0, and the places of the X series' control table that we use. Everything is
/// little-endian. Facts and their sources: services/robot/README.md.
namespace prehend::robot::dynamixel {

enum class Instruction : std::uint8_t {
  ping = 0x01,
  read = 0x02,
  write = 0x03,
  reboot = 0x08,
  status = 0x55,
  sync_read = 0x82,
  sync_write = 0x83
};

inline constexpr std::uint8_t broadcast = 0xfe;
inline constexpr std::uint8_t last_id = 252;

/// What is said to a servo, or by it. Of a status the first parameter is its error.
struct Packet {
  std::uint8_t id = 0;
  Instruction instruction = Instruction::status;
  std::string parameters;

  bool operator==(const Packet&) const = default;
};

/// Of the bytes before it: polynomial 0x8005, from 0, highest bit first.
std::uint16_t crc(std::string_view bytes);

/// As it goes over the wire: with header, length, stuffed bytes and CRC.
std::string encode(const Packet& packet);

/// Finds packets among bytes. What is none is skipped and counted.
class Parser {
 public:
  void feed(std::string_view bytes);
  /// The next whole packet; nothing: more bytes are needed.
  std::optional<Packet> next();
  /// Forgets what has not become a packet.
  void clear() { bytes_.clear(); }
  bool is_empty() const { return bytes_.empty(); }
  /// Packets whose CRC or length was wrong, since the last call.
  int take_broken();

 private:
  bool find_header();

  std::string bytes_;
  int broken_ = 0;
};

// --- status

inline constexpr std::size_t status_bytes = 11;  // of one without parameters

/// Of a status' error: something is wrong with the hardware, whatever was asked.
inline constexpr std::uint8_t alert = 0x80;
enum Refusal : std::uint8_t {
  instruction_error = 2,
  crc_error = 3,
  range_error = 4,
  length_error = 5,
  access_error = 7
};
std::string explain_refusal(std::uint8_t error);

/// Bits of the hardware's error.
enum HardwareError : std::uint8_t { overheated = 4, overloaded = 32 };
std::string explain_hardware(std::uint8_t bits);

// --- control table

struct Item {
  std::uint16_t address;
  std::uint8_t size;  // bytes

  bool operator==(const Item&) const = default;
};
namespace table {
inline constexpr Item operating_mode{11, 1}, temperature_limit{31, 1}, current_limit{38, 2},
    torque_enable{64, 1}, status_return{68, 1}, hardware_error{70, 1}, watchdog{98, 1},
    goal_current{102, 2}, profile_velocity{112, 4}, goal_position{116, 4}, present_current{126, 2},
    present_velocity{128, 4}, present_position{132, 4}, temperature{146, 1};
/// Current, velocity and position stand beside each other.
inline constexpr Item motion{126, 10};
inline constexpr std::size_t size = 228;
}  // namespace table

inline constexpr int current_based_position =
    5;                                          // operating mode: to a place, by at most a current
inline constexpr int pulses_per_turn = 4096;    // of a position
inline constexpr double velocity_unit = 0.229;  // rev/min
inline constexpr double pulses_per_second(int velocity) {
  return velocity * velocity_unit / 60 * pulses_per_turn;
}
inline constexpr int watchdog_unit_ms = 20;        // of the bus watchdog, 1 to 127 of them
inline constexpr std::uint8_t watchdog_bit = 255;  // what it says when nobody spoke for so long
inline constexpr int max_pulses = 1048575;         // either way, of this operating mode

std::string little_endian(std::int64_t value, std::size_t size);
/// Of 1 byte without a sign, of 2 or 4 with one.
std::int32_t number(std::string_view bytes);

/// Parameters of instructions.
std::string read_of(const Item& item);
std::string write_of(const Item& item, std::int64_t value);

}  // namespace prehend::robot::dynamixel
