#pragma once

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/pose.hpp"

/// Messages of ROS 2 as bytes on the wire (idl/ros2): plain CDR behind the four bytes that say so;
/// each number lies at a multiple of its size behind these. Pure.
namespace prehend::ros2 {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::size_t encapsulation = 4;  // bytes

/// What to do about a message that is none.
inline constexpr const char* type_hint = "ros2 topic info --verbose shows who tells which type";

/// Makes them, little endian.
class CdrWriter {
 public:
  void put(std::uint32_t value) { number(value); }
  void put(std::int32_t value) { number(static_cast<std::uint32_t>(value)); }
  void put(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  void put(std::uint8_t value) { bytes_.push_back(value); }
  void put(std::string_view text);
  void put(const std::string& text) { put(std::string_view(text)); }
  template <class T>
  void put(const std::vector<T>& all) {
    put(static_cast<std::uint32_t>(all.size()));
    for (const T& one : all) put(one);
  }
  /// An array of fixed length.
  template <std::size_t N>
  void put(const std::array<double, N>& all) {
    for (const double one : all) put(one);
  }
  /// builtin_interfaces/Time, and Duration.
  void stamp(std::int64_t ns);
  /// geometry_msgs/Transform, and Pose.
  void put(const Pose& X);
  Bytes bytes() && { return std::move(bytes_); }

 private:
  template <class Number>
  void number(Number value) {
    while ((bytes_.size() - encapsulation) % sizeof(Number) != 0) bytes_.push_back(0);
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xff));
  }

  Bytes bytes_{0, 1, 0, 0};
};

/// Reads them, of either byte order. Once something is not there, all that follows is zero or
/// empty, and good() false. Nothing is allocated that the bytes have no room for.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> bytes);

  bool good() const { return good_; }
  std::uint8_t byte();
  std::uint32_t count();  // uint32
  double real();
  std::string text();
  std::vector<double> reals();
  std::vector<std::uint8_t> bytes();
  std::vector<std::string> texts();
  std::int64_t stamp();  // ns
  /// geometry_msgs/Pose: metres, and a quaternion that need not be one of a rotation.
  std::pair<Eigen::Vector3d, Eigen::Quaterniond> pose();

  /// Items of a sequence, of at least so many bytes each; 0 where they cannot all be there.
  std::uint32_t length(std::size_t smallest);

 private:
  template <class Number>
  Number number();
  std::size_t left() const { return bytes_.size() - at_; }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = encapsulation;
  bool good_ = false, little_ = true;
};

}  // namespace prehend::ros2
