#include "common/ros2/pixels.hpp"

#include <algorithm>
#include <array>

#include "common/base/printable.hpp"

namespace prehend::ros2 {
namespace {

constexpr std::uint32_t max_pixels = 16384;  // along a side

struct Encoding {
  const char* name;
  Pixels pixels;
  std::uint64_t bytes;     // a pixel
  std::uint32_t cell = 1;  // px along a side that belong together
};
constexpr std::array<Encoding, 16> encodings{{
    {"rgb8", Pixels::rgb, 3},
    {"bgr8", Pixels::bgr, 3},
    {"8UC3", Pixels::bgr, 3},
    {"rgba8", Pixels::rgba, 4},
    {"bgra8", Pixels::bgra, 4},
    {"mono8", Pixels::grey, 1},
    {"8UC1", Pixels::grey, 1},
    {"mono16", Pixels::grey_low_first, 2},
    {"bayer_rggb8", Pixels::mosaic_rggb, 1, 2},
    {"bayer_bggr8", Pixels::mosaic_bggr, 1, 2},
    {"bayer_gbrg8", Pixels::mosaic_gbrg, 1, 2},
    {"bayer_grbg8", Pixels::mosaic_grbg, 1, 2},
    {"yuv422", Pixels::uyvy, 2, 2},
    {"uyvy", Pixels::uyvy, 2, 2},
    {"yuv422_yuy2", Pixels::yuyv, 2, 2},
    {"yuyv", Pixels::yuyv, 2, 2},
}};

}  // namespace

Expected<Pixels> pixels_of(const RawPicture& picture, const std::string& where) {
  const auto known = std::ranges::find(encodings, picture.encoding, &Encoding::name);
  if (known == encodings.end())
    return fail(
        "has the encoding «" + printable(picture.encoding.substr(0, 64)) + "», which is no picture",
        where, "rgb8, bgr8, mono8, bayer_*8 and yuv422 are known, or take its topic /compressed");
  const auto is_side = [&](std::uint32_t side) {
    return side > 0 && side <= max_pixels && side % known->cell == 0;
  };
  if (!is_side(picture.width) || !is_side(picture.height) ||
      picture.step < picture.width * known->bytes || picture.step > 16 * max_pixels ||
      std::uint64_t{picture.step} * picture.height > picture.data.size())
    return fail("has not the bytes that its width, height and step tell", where);
  return picture.big_endian && known->pixels == Pixels::grey_low_first ? Pixels::grey_high_first
                                                                       : known->pixels;
}

}  // namespace prehend::ros2
