#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The serial protocol of BarrettHands BH8-250, -262 and their kin. Supervisory mode: a line of
/// text, ended by a carriage return, is answered by text and the prompt. RealTime mode, after LOOP:
/// a control block of bytes is answered by a feedback block. Facts and their sources:
/// services/robot/README.md.
namespace prehend::robot::barrett {

inline constexpr std::size_t motors = 4;  // in the order of the wire: fingers 1, 2, 3, spread
inline constexpr std::string_view prompt = "=> ";
inline constexpr char end_of_line = '\r';
inline constexpr char abort_key = '\x03';  // ends whatever goes on
/// The same where the last control block may have lost bytes: those eat as many of these.
inline constexpr std::string_view abort_surely = "\x03\x03\x03\x03\x03";
inline constexpr char acknowledgement = '*';

/// The DoF of the hand's description that each motor drives.
inline constexpr std::array<std::size_t, motors> dof_of{1, 2, 3, 0};

/// The strain that a finger without a gauge says.
inline constexpr int no_gauge = 255;

/// Counts of the encoders from open to closed.
inline constexpr int finger_counts = 17800;  // 140°
inline constexpr int spread_counts = 3150;   // 180°
double counts_per_radian(std::size_t motor);
int max_counts(std::size_t motor);

/// Bits of what S and ERR say.
enum Status : int {
  not_initialized = 4,
  position_not_reached = 16,
  unknown_command = 32,
  unknown_parameter = 64,
  invalid_value = 128,
  read_only = 256,
  too_many_arguments = 1024,
  invalid_header = 2048,
  no_motor_prefix = 4096,
  over_temperature = 8192,
  aborted = 16384
};
std::string explain(int status);

/// An answer in supervisory mode: its lines without the echo of nothing, and the error it ends
/// with.
struct Reply {
  std::vector<std::string> lines;
  int error = 0;
};
/// Of what came before the prompt. Whatever cannot be text is left out.
Reply parse_reply(std::string_view text);
/// All numbers of an answer, if it is nothing but numbers that fit.
std::optional<std::vector<int>> numbers(const Reply& reply);

/// The words of a line, and the number that a word is.
std::vector<std::string> words_of(std::string_view line);
std::optional<int> number_of(std::string_view word);

/// Which motors a prefix names, by their bits; nothing for what is no prefix. Empty: all four.
std::optional<unsigned> motors_of(std::string_view prefix);

// --- RealTime mode: each motor sends its strain (1 byte) and its position (2 bytes, high first),
// and after them comes the temperature, of 2, 1 or no bytes, as firmware differs.

struct Feedback {
  std::array<int, motors> strain{}, position{};
  std::optional<double> temperature;  // °C
};
inline constexpr std::size_t motor_bytes = 3;
/// Without the acknowledgement before it.
std::size_t feedback_size(int temperature_bytes);

/// Exactly as many bytes as it takes. Nothing: no hand is so hot, or so cold, or has its joints
/// there.
std::optional<Feedback> decode(std::string_view bytes, int temperature_bytes);

/// Velocities as signed bytes; asks for a feedback block. None of them ends a line, or a hand that
/// has left RealTime mode unheard would read the header as its command to close.
std::string control_block(const std::array<std::int8_t, motors>& velocity);

}  // namespace prehend::robot::barrett
