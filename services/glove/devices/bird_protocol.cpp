#include "services/glove/devices/bird_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/pose.hpp"

namespace prehend::glove::bird {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double full_scale = 32768;
constexpr double pi = std::numbers::pi;
constexpr std::array button_codes{0x10, 0x30, 0x70};  // left, middle, right

bool has_position(Format format) {
  return format == Format::position || format >= Format::position_angles;
}
bool has_angles(Format format) {
  return format == Format::angles || format == Format::position_angles;
}
bool has_matrix(Format format) {
  return format == Format::matrix || format == Format::position_matrix;
}
bool has_quaternion(Format format) {
  return format == Format::quaternion || format == Format::position_quaternion;
}

/// A word has 14 significant bits in two bytes of seven, the lower ones first.
double word(std::string_view bytes, std::size_t i) {
  const auto low = static_cast<std::uint8_t>(bytes[2 * i]) & 0x7fu;
  const auto high = static_cast<std::uint8_t>(bytes[2 * i + 1]) & 0x7fu;
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(high << 9 | low << 2)) / full_scale;
}

/// `fraction` of full scale, -1 to 1.
void append_word(std::string& bytes, double fraction) {
  // Rounded to the 14 bits that are sent: a step is 4 of 32768.
  const double steps = std::clamp(std::round(fraction * full_scale / 4), -8192.0, 8191.0);
  const auto value = static_cast<std::uint16_t>(static_cast<std::int16_t>(steps * 4));
  bytes.push_back(static_cast<char>(value >> 2 & 0x7f));
  bytes.push_back(static_cast<char>(value >> 9 & 0x7f));
}

Matrix3d from_angles(const Vector3d& angles) {
  return (AngleAxisd(angles.x(), Vector3d::UnitZ()) * AngleAxisd(angles.y(), Vector3d::UnitY()) *
          AngleAxisd(angles.z(), Vector3d::UnitX()))
      .toRotationMatrix();
}

Vector3d to_angles(const Matrix3d& R) {
  const double elevation = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  if (std::abs(R(2, 0)) > 1 - 1e-12)  // azimuth and roll turn about the same axis
    return {std::atan2(-R(0, 1), R(1, 1)), elevation, 0};
  return {std::atan2(R(1, 0), R(0, 0)), elevation, std::atan2(R(2, 1), R(2, 2))};
}

}  // namespace

const FormatInfo& info(Format format) {
  return formats[static_cast<std::size_t>(format)];
}

std::optional<Format> format_of_command(char command) {
  for (const FormatInfo& entry : formats)
    if (entry.command == command) return entry.format;
  return std::nullopt;
}

std::optional<Format> format_of_name(std::string_view name) {
  for (const FormatInfo& entry : formats)
    if (entry.name == name) return entry.format;
  return std::nullopt;
}

const HemisphereInfo* find_hemisphere(std::string_view name) {
  for (const HemisphereInfo& entry : hemispheres)
    if (entry.name == name) return &entry;
  return nullptr;
}

std::size_t examined_length(std::uint8_t parameter) {
  switch (parameter) {
    case status:
    case revision:
    case position_scaling:
      return 2;
    case error_code:
    case group_mode:
      return 1;
    case model_name:
      return 10;
    case system_status:
      return max_units;
    default:
      return 0;
  }
}

std::size_t changed_length(std::uint8_t parameter) {
  switch (parameter) {
    case position_scaling:
      return 2;
    case group_mode:
    case auto_configure:
      return 1;
    default:
      return 0;
  }
}

std::optional<Matrix3d> Record::rotation() const {
  if (matrix) {
    const auto nearest = nearest_rotation(*matrix);
    if (nearest) return *nearest;
    return std::nullopt;
  }
  if (quaternion) {
    if (quaternion->norm() < 0.5) return std::nullopt;
    return quaternion->normalized().toRotationMatrix();
  }
  if (angles) return from_angles(*angles);
  return std::nullopt;
}

std::optional<Record> decode(std::string_view bytes, const Layout& layout) {
  if (bytes.size() != layout.length()) return std::nullopt;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    if (((static_cast<std::uint8_t>(bytes[i]) & 0x80u) != 0) != (i == 0)) return std::nullopt;

  Record record;
  record.format = layout.format;
  std::size_t next = 0;
  const auto vector = [&](double scale) {
    const Vector3d v(word(bytes, next), word(bytes, next + 1), word(bytes, next + 2));
    next += 3;
    return Vector3d(scale * v);
  };
  if (has_position(layout.format)) record.position = vector(layout.range);
  if (has_angles(layout.format)) record.angles = vector(pi);
  if (has_matrix(layout.format)) {
    Matrix3d M;
    for (int row = 0; row < 3; ++row) M.row(row) = vector(1).transpose();
    record.matrix = M;
  }
  if (has_quaternion(layout.format))
    record.quaternion = Eigen::Quaterniond(word(bytes, next), word(bytes, next + 1),
                                           word(bytes, next + 2), word(bytes, next + 3));
  std::size_t after = info(layout.format).length;
  if (layout.button) record.button = bytes[after++];
  if (layout.group) record.address = bytes[after];
  return record;
}

std::optional<std::vector<std::uint8_t>> held_buttons(int code) {
  if (code == 0) return std::vector<std::uint8_t>();
  for (std::uint8_t i = 0; i < button_codes.size(); ++i)
    if (code == button_codes[i]) return std::vector{static_cast<std::uint8_t>(i + 1)};
  return std::nullopt;
}

int button_code(const std::vector<std::uint8_t>& held) {
  for (std::uint8_t i = 0; i < button_codes.size(); ++i)
    if (std::find(held.begin(), held.end(), i + 1) != held.end()) return button_codes[i];
  return 0;
}

std::string encode(const Vector3d& position, const Matrix3d& rotation, const Layout& layout,
                   int address, int button) {
  std::string bytes;
  if (has_position(layout.format))
    for (int i = 0; i < 3; ++i) append_word(bytes, position[i] / layout.range);
  if (has_angles(layout.format)) {
    const Vector3d angles = to_angles(rotation);
    for (int i = 0; i < 3; ++i) append_word(bytes, angles[i] / pi);
  }
  if (has_matrix(layout.format))
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) append_word(bytes, rotation(row, column));
  if (has_quaternion(layout.format)) {
    const Eigen::Quaterniond q(rotation);
    for (const double x : {q.w(), q.x(), q.y(), q.z()}) append_word(bytes, x);
  }
  bytes[0] = static_cast<char>(static_cast<std::uint8_t>(bytes[0]) | 0x80u);
  if (layout.button) bytes.push_back(static_cast<char>(button & 0x7f));
  if (layout.group) bytes.push_back(static_cast<char>(address & 0x7f));
  return bytes;
}

std::vector<Record> RecordParser::feed(std::string_view bytes) {
  std::vector<Record> records;
  for (const char byte : bytes) {
    const bool first = (static_cast<std::uint8_t>(byte) & 0x80u) != 0;
    if (first) {
      garbage_ += pending_.size();  // a record that lost its end
      pending_.clear();
    } else if (pending_.empty()) {
      ++garbage_;  // the end of one that lost its beginning
      continue;
    }
    pending_.push_back(byte);
    if (pending_.size() == layout_.length()) {
      if (auto record = decode(pending_, layout_)) records.push_back(*record);
      pending_.clear();
    }
  }
  return records;
}

}  // namespace prehend::glove::bird
