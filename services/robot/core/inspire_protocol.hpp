#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"

/// Frames of Inspire's hands of six motors, and the places of their memory that we use. Numbers are
/// little-endian. Facts and their sources: services/robot/core/README.md.
namespace prehend::robot::inspire {

inline constexpr std::size_t motors = 6;
inline constexpr std::uint8_t usual_id = 1, last_id = 254;
/// DoFs of the hand, in the order of its motors.
inline constexpr std::array<std::string_view, motors> dof_names{
    "little", "ring", "middle", "index", "thumb bend", "thumb rotation"};

enum class Command : std::uint8_t { read = 0x11, write = 0x12 };
/// Whose frames: their headers differ.
enum class Side { asks, answers };

/// data: of a read's question how many bytes, of its answer these; of a write's question the bytes,
/// of its answer a one.
struct Frame {
  std::uint8_t id = 0;
  Command command = Command::read;
  std::uint16_t address = 0;
  std::string data;

  bool operator==(const Frame&) const = default;
};
std::string encode(Side side, const Frame& frame);

/// Finds frames among bytes. What is none is skipped and counted.
class Parser {
 public:
  explicit Parser(Side side) : side_(side) {}
  void feed(std::string_view bytes) { bytes_.append(bytes); }
  /// The next whole frame; nothing: more bytes are needed.
  std::optional<Frame> next();
  /// Forgets what has not become a frame.
  void clear() { bytes_.clear(); }
  bool is_empty() const { return bytes_.empty(); }
  /// Frames whose sum or length was wrong, since the last call.
  int take_broken();

 private:
  bool find_header();

  Side side_;
  std::string bytes_;
  int broken_ = 0;
};

/// A block of values, one a motor.
struct Block {
  std::uint16_t address;
  std::uint8_t size;  // bytes of a value: 2 with a sign, 1 without
  constexpr std::uint8_t bytes() const { return static_cast<std::uint8_t>(size * motors); }
};
namespace table {
inline constexpr Block angle_set{1486, 2}, force_set{1498, 2}, speed_set{1522, 2},
    angle_now{1546, 2}, force_now{1582, 2}, current_now{1594, 2}, error{1606, 1}, status{1612, 1},
    temperature{1618, 1};
inline constexpr std::uint16_t clear_error = 1004;
}  // namespace table

using Values = std::array<int, motors>;
std::string bytes_of(const Block& block, const Values& values);
/// Nothing: it has not the block's length.
std::optional<Values> values_of(const Block& block, std::string_view bytes);

inline constexpr int open_count = 1000;        // of an angle; closed is 0
inline constexpr int leave = -1;               // of an angle that is set: as it was
inline constexpr int full = 1000;              // of force and speed
inline constexpr double fastest_stroke = 0.8;  // s, from end to end at full speed

enum Status : std::uint8_t {
  opening = 0,
  closing = 1,
  arrived = 2,
  at_force = 3,
  at_current = 5,
  stalled = 6,
  failed = 7
};
/// Bits of an error.
enum ErrorBit : std::uint8_t { stall = 1, hot = 2, overcurrent = 4, broken = 8, unheard = 16 };
std::string explain_error(int bits);

/// Counts of an angle, and what they are of a DoF.
double dof_of(const model::HandDof& dof, double count);
double count_of(const model::HandDof& dof, double value);  // not rounded

/// Refuses a hand that has other DoFs.
Expected<void> check_hand(const model::HandModel& hand);

}  // namespace prehend::robot::inspire
