#pragma once

#include <string>

#include "common/base/error.hpp"
#include "common/ros2/pictures.hpp"

namespace prehend::ros2 {

/// How raw pictures hold colours: bytes of a pixel in this order; grey of 16 bits with its low or
/// its high byte first; the letters of a mosaic's first two rows; two pixels in four bytes.
enum class Pixels {
  rgb,
  bgr,
  rgba,
  bgra,
  grey,
  grey_low_first,
  grey_high_first,
  mosaic_rggb,
  mosaic_bggr,
  mosaic_gbrg,
  mosaic_grbg,
  uyvy,
  yuyv,
};

/// rgb8, bgr8, rgba8, bgra8, mono8, mono16, 8UC1, 8UC3 (blue first), bayer_*8 and both yuv422.
/// Refused: other encodings, as those of depth; sides of 0 or more than 16384 px; pairs and squares
/// that are cut; fewer bytes than width, height and step tell.
Expected<Pixels> pixels_of(const RawPicture& picture, const std::string& where = {});

}  // namespace prehend::ros2
