#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/ros2/cdr.hpp"

/// What nodes of ROS 2 say of a camera. Pure.
namespace prehend::ros2 {

/// sensor_msgs/CompressedImage: a jpeg or png, as the bytes of its file.
struct CompressedPicture {
  std::int64_t stamp_ns = 0;
  std::string frame = {}, format = {};
  std::vector<std::uint8_t> data;
};
Bytes compressed_image(const CompressedPicture& picture);
Expected<CompressedPicture> parse_compressed_image(std::span<const std::uint8_t> bytes);

/// sensor_msgs/Image: rows of `step` bytes from the top, pixels as `encoding` says.
struct RawPicture {
  std::int64_t stamp_ns = 0;
  std::string frame = {}, encoding = {};
  std::uint32_t width = 0, height = 0, step = 0;
  bool big_endian = false;
  std::vector<std::uint8_t> data;
};
/// Whether its bytes are enough is not asked.
Expected<RawPicture> parse_image(std::span<const std::uint8_t> bytes);

/// A lens, px, with OpenCV's k1 k2 p1 p2 k3 for its distortion.
struct Lens {
  std::uint32_t width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::vector<double> distortion;
};
/// sensor_msgs/CameraInfo: distortion model «plumb_bob», pictures as they come.
Bytes camera_info(std::int64_t stamp_ns, std::string_view frame, const Lens& lens);
/// Refused: numbers that are not finite, and models of distortion other than «plumb_bob» and none.
Expected<Lens> parse_camera_info(std::span<const std::uint8_t> bytes);

}  // namespace prehend::ros2
