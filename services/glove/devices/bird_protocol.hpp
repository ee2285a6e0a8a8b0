#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Ascension's Flock of Birds command set over RS-232. That the Nest of Birds, the four-sensor box
/// of the same family, uses it unchanged is an assumption of ours.
namespace prehend::glove::bird {

/// What a record carries.
enum class Format {
  position,
  angles,
  matrix,
  quaternion,
  position_angles,
  position_matrix,
  position_quaternion
};

struct FormatInfo {
  Format format;
  std::string_view name;
  char command;        // that asks for it
  std::size_t length;  // bytes of a record, without button and address
};

inline constexpr std::array formats{
    FormatInfo{Format::position, "position", 'V', 6},
    FormatInfo{Format::angles, "angles", 'W', 6},
    FormatInfo{Format::matrix, "matrix", 'X', 18},
    FormatInfo{Format::quaternion, "quaternion", '\\', 8},
    FormatInfo{Format::position_angles, "position_angles", 'Y', 12},
    FormatInfo{Format::position_matrix, "position_matrix", 'Z', 24},
    FormatInfo{Format::position_quaternion, "position_quaternion", ']', 14}};

const FormatInfo& info(Format format);
std::optional<Format> format_of_command(char command);
std::optional<Format> format_of_name(std::string_view name);

/// Parameters to examine ('O') and change ('P'), and the bytes of their values; 0: cannot be.
enum Parameter : std::uint8_t {
  status = 0,
  revision = 1,
  position_scaling = 3,  // 0: 36 inches, 1: 72 inches
  error_code = 10,
  model_name = 15,
  group_mode = 35,
  system_status = 36,
  auto_configure = 50
};
std::size_t examined_length(std::uint8_t parameter);
std::size_t changed_length(std::uint8_t parameter);

/// Bits of a unit's byte in the system status.
inline constexpr std::uint8_t accessible = 0x80, running = 0x40, has_receiver = 0x20,
                              extended_range = 0x10;
inline constexpr std::size_t max_units = 14;

inline constexpr double inch = 0.0254;            // m
inline constexpr double short_range = 36 * inch;  // full scale of a position word, m
inline constexpr double long_range = 72 * inch;
/// Of an extended range transmitter, whatever the position scaling says.
inline constexpr double extended_scale = 144 * inch;

/// The side of the transmitter where the sensors are. On the other side they would be reported at
/// the point opposite: the field is the same there. z of the transmitter points down.
struct HemisphereInfo {
  std::string_view name;
  int axis;              // 0, 1, 2
  int sign;              // of the coordinate on that side
  std::uint8_t code[2];  // behind the command L
};

inline constexpr std::array hemispheres{
    HemisphereInfo{"front", 0, 1, {0x00, 0x00}}, HemisphereInfo{"rear", 0, -1, {0x00, 0x01}},
    HemisphereInfo{"right", 1, 1, {0x06, 0x00}}, HemisphereInfo{"left", 1, -1, {0x06, 0x01}},
    HemisphereInfo{"lower", 2, 1, {0x0C, 0x00}}, HemisphereInfo{"upper", 2, -1, {0x0C, 0x01}}};

const HemisphereInfo* find_hemisphere(std::string_view name);

/// Numbers of the mouse buttons that are held, from 1, as the byte behind the words has them: 0x10
/// left, 0x30 middle, 0x70 right, of which only one is told. Nothing: it is none of these. The
/// codes are those of the Flock of Birds; we had no mouse to check them with.
std::optional<std::vector<std::uint8_t>> held_buttons(int code);
int button_code(const std::vector<std::uint8_t>& held);

/// How records look on the line at present.
struct Layout {
  Format format = Format::position_matrix;
  bool button = false;         // a byte with the mouse button behind the words
  bool group = false;          // then the address of the unit
  double range = short_range;  // m

  std::size_t length() const { return info(format).length + button + group; }
};

/// One measurement in SI units. R: rotation of the sensor in the transmitter's frame.
struct Record {
  Format format = Format::position;
  std::optional<Eigen::Vector3d> position;       // m
  std::optional<Eigen::Vector3d> angles;         // rad: azimuth (z), elevation (y), roll (x)
  std::optional<Eigen::Matrix3d> matrix;         // as sent; nearly orthonormal at best
  std::optional<Eigen::Quaterniond> quaternion;  // as sent
  std::optional<int> button;
  std::optional<int> address;

  /// Orientation from whatever was sent, orthonormal; none if it cannot be a rotation.
  std::optional<Eigen::Matrix3d> rotation() const;
};

/// The bytes of a record; `bytes` must be layout.length() long, with bit 7 set in the first byte
/// alone. Nothing else is refused: any 14 bits are a number.
std::optional<Record> decode(std::string_view bytes, const Layout& layout);

/// The bytes that a tracker would send. Positions beyond the range are clamped, as it does.
std::string encode(const Eigen::Vector3d& position, const Eigen::Matrix3d& rotation,
                   const Layout& layout, int address = 1, int button = 0);

/// Cuts a stream into records. Finds its place again by the phase bit after lost or foreign bytes.
class RecordParser {
 public:
  explicit RecordParser(const Layout& layout) : layout_(layout) {}

  const Layout& layout() const { return layout_; }
  /// Records that are complete now.
  std::vector<Record> feed(std::string_view bytes);
  /// Bytes that belonged to no record.
  std::uint64_t garbage() const { return garbage_; }
  /// Bytes of a record that is not complete yet.
  std::size_t pending() const { return pending_.size(); }

 private:
  Layout layout_;
  std::string pending_;
  std::uint64_t garbage_ = 0;
};

}  // namespace prehend::glove::bird
