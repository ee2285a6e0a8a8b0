#include "services/recognition/cameras/raw_picture.hpp"

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/base/printable.hpp"

namespace prehend::recognition {
namespace {

constexpr std::size_t max_pixels = 40'000'000;

struct Encoding {
  const char* name;
  int type;        // of OpenCV, of its pixels
  int conversion;  // to RGB; -1: it is
  bool even = false;
};
constexpr std::array<Encoding, 16> encodings{{
    {"rgb8", CV_8UC3, -1},
    {"bgr8", CV_8UC3, cv::COLOR_BGR2RGB},
    {"8UC3", CV_8UC3, cv::COLOR_BGR2RGB},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2RGB},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2RGB},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2RGB},
    {"8UC1", CV_8UC1, cv::COLOR_GRAY2RGB},
    {"mono16", CV_8UC2, cv::COLOR_GRAY2RGB},
    // OpenCV names squares by the pixels that begin in their second row and column.
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2RGB, true},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2RGB, true},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2RGB, true},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2RGB, true},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2RGB_UYVY, true},
    {"uyvy", CV_8UC2, cv::COLOR_YUV2RGB_UYVY, true},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2RGB_YUYV, true},
    {"yuyv", CV_8UC2, cv::COLOR_YUV2RGB_YUYV, true},
}};

}  // namespace

Expected<Picture> picture_of(const ros2::RawPicture& raw, const std::string& where) {
  const auto known = std::ranges::find(encodings, raw.encoding, &Encoding::name);
  if (known == encodings.end())
    return fail("has the encoding «" + printable(raw.encoding.substr(0, 64)) + "»", where,
                "rgb8, bgr8, mono8, bayer_*8 and yuv422 are known, or take its topic /compressed");
  if (raw.width < 8 || raw.height < 8) return fail("is smaller than 8 px", where);
  if (std::size_t{raw.width} * raw.height > max_pixels)
    return fail("has more than 40 million pixels", where, "make it smaller");
  if (raw.step < raw.width * CV_ELEM_SIZE(known->type) ||
      std::size_t{raw.step} * raw.height > raw.data.size() ||
      (known->even && (raw.width % 2 != 0 || raw.height % 2 != 0)))
    return fail("has not the bytes that its width, height and step tell", where);
  const int rows = static_cast<int>(raw.height), columns = static_cast<int>(raw.width);
  cv::Mat pixels(rows, columns, known->type, const_cast<std::uint8_t*>(raw.data.data()), raw.step);
  if (raw.encoding == "mono16") {
    cv::Mat high;
    cv::extractChannel(pixels, high, raw.big_endian ? 0 : 1);
    pixels = high;
  }
  Picture picture(columns, rows);
  cv::Mat rgb(rows, columns, CV_8UC3, picture.rgb.data());
  if (known->conversion < 0)
    pixels.copyTo(rgb);
  else
    cv::cvtColor(pixels, rgb, known->conversion);
  return picture;
}

}  // namespace prehend::recognition
