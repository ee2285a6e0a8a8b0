#include "services/recognition/cameras/raw_picture.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/ros2/pixels.hpp"

namespace prehend::recognition {
namespace {

constexpr std::size_t max_pixels = 40'000'000;

/// Of OpenCV.
int type_of(ros2::Pixels pixels) {
  using enum ros2::Pixels;
  switch (pixels) {
    case rgb:
    case bgr:
      return CV_8UC3;
    case rgba:
    case bgra:
      return CV_8UC4;
    case grey_low_first:
    case grey_high_first:
    case uyvy:
    case yuyv:
      return CV_8UC2;
    default:
      return CV_8UC1;
  }
}

/// To red, green, blue; nothing: it is.
std::optional<int> conversion_of(ros2::Pixels pixels) {
  using enum ros2::Pixels;
  switch (pixels) {
    case rgb:
      return std::nullopt;
    case bgr:
      return cv::COLOR_BGR2RGB;
    case rgba:
      return cv::COLOR_RGBA2RGB;
    case bgra:
      return cv::COLOR_BGRA2RGB;
    // OpenCV names mosaics by the pixels that begin in their second row and column.
    case mosaic_rggb:
      return cv::COLOR_BayerBG2RGB;
    case mosaic_bggr:
      return cv::COLOR_BayerRG2RGB;
    case mosaic_gbrg:
      return cv::COLOR_BayerGR2RGB;
    case mosaic_grbg:
      return cv::COLOR_BayerGB2RGB;
    case uyvy:
      return cv::COLOR_YUV2RGB_UYVY;
    case yuyv:
      return cv::COLOR_YUV2RGB_YUYV;
    case grey:
    case grey_low_first:
    case grey_high_first:
      break;
  }
  return cv::COLOR_GRAY2RGB;
}

}  // namespace

Expected<Picture> picture_of(const ros2::RawPicture& raw, const std::string& where) {
  if (raw.width < 8 || raw.height < 8) return fail("is smaller than 8 px", where);
  if (std::size_t{raw.width} * raw.height > max_pixels)
    return fail("has more than 40 million pixels", where, "make it smaller");
  const auto pixels = ros2::pixels_of(raw, where);
  if (!pixels) return tl::unexpected(pixels.error());
  const int rows = static_cast<int>(raw.height), columns = static_cast<int>(raw.width);
  cv::Mat given(rows, columns, type_of(*pixels), const_cast<std::uint8_t*>(raw.data.data()),
                raw.step);
  if (*pixels == ros2::Pixels::grey_low_first || *pixels == ros2::Pixels::grey_high_first) {
    cv::Mat high;
    cv::extractChannel(given, high, *pixels == ros2::Pixels::grey_high_first ? 0 : 1);
    given = high;
  }
  Picture picture(columns, rows);
  cv::Mat shown(rows, columns, CV_8UC3, picture.rgb.data());
  if (const auto conversion = conversion_of(*pixels))
    cv::cvtColor(given, shown, *conversion);
  else
    given.copyTo(shown);
  return picture;
}

}  // namespace prehend::recognition
