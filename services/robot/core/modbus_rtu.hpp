#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Modbus RTU, as far as registers go: frames of both sides. Everything is big-endian but the CRC.
/// Facts and their sources: services/robot/core/README.md.
namespace prehend::robot::modbus {

enum class Function : std::uint8_t {
  read_holding = 0x03,
  read_input = 0x04,
  write = 0x10,
  write_and_read = 0x17,
};

using Registers = std::vector<std::uint16_t>;

/// What is said to a device, or by it, between its id and the CRC.
struct Frame {
  std::uint8_t id = 0;
  std::uint8_t function = 0;  // of a refusal with the highest bit
  std::string data;

  bool operator==(const Frame&) const = default;
};

/// Of the bytes before it: polynomial 0xA001 from 0xFFFF, lowest bit first.
std::uint16_t crc(std::string_view bytes);
std::string encode(const Frame& frame);

/// Questions.
Frame read(std::uint8_t id, Function function, std::uint16_t address, std::uint16_t count);
Frame write(std::uint8_t id, std::uint16_t address, const Registers& values);

/// Whose frames a parser finds: their lengths differ.
enum class Side { asks, answers };

/// Finds frames among bytes. What is none is skipped and counted. Frames have no mark where they
/// begin: the CRC tells them.
class Parser {
 public:
  explicit Parser(Side side) : side_(side) {}
  void feed(std::string_view bytes) { bytes_.append(bytes); }
  /// The next whole frame; nothing: more bytes are needed.
  std::optional<Frame> next();
  /// Forgets what has not become a frame.
  void clear() { bytes_.clear(); }
  bool is_empty() const { return bytes_.empty(); }
  /// Pieces that were no frame, since the last call.
  int take_broken();

 private:
  Side side_;
  std::string bytes_;
  bool in_damage_ = false;
  int broken_ = 0;
};

inline constexpr std::uint8_t refused = 0x80;  // in an answer's function
std::string explain_refusal(std::uint8_t code);

std::uint16_t word(std::string_view bytes, std::size_t at);
std::string words(const Registers& values);
/// The registers of an answer to a read; nothing: it has not so many.
std::optional<Registers> registers_of(const Frame& answer, std::size_t count);

/// What a device says to a question about registers: it has `count` from `address` on for writing
/// (`written`), and for reading those that `status` begins at.
struct Map {
  std::uint16_t written_at = 0, status_at = 0;
  Registers written, status;
};
/// Takes what is written into the map; nothing: no answer, for it is another's.
std::optional<Frame> answer(const Frame& question, std::uint8_t id, Map& map);

}  // namespace prehend::robot::modbus
