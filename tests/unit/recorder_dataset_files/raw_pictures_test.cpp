// Pictures as cameras give them, without a file around: each encoding shows the same colours, and
// what stands beside the bytes is believed only where the bytes are there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "common/base/random.hpp"
#include "services/recorder/tools/dataset/message.hpp"
#include "services/recorder/tools/dataset/picture_file.hpp"
#include "services/recorder/tools/dataset/pictures.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr int width = 32, height = 24;

/// Red grows to the right, green downwards.
cv::Mat shades() {
  cv::Mat rgb(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      rgb.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(40 + 5 * x),
                                 static_cast<std::uint8_t>(40 + 6 * y), 90};
  return rgb;
}

struct Image {
  double width, height, step;
  std::string encoding;
  bool big_endian = false;
  Bytes data;
};

/// Rows with bytes between them.
Image padded(const cv::Mat& pixels, const std::string& encoding) {
  const std::size_t row = pixels.elemSize() * static_cast<std::size_t>(pixels.cols);
  Image made{double(pixels.cols), double(pixels.rows), double(row + 5), encoding, false, {}};
  for (int y = 0; y < pixels.rows; ++y) {
    made.data.insert(made.data.end(), pixels.ptr(y), pixels.ptr(y) + row);
    made.data.insert(made.data.end(), 5, 255);
  }
  return made;
}

/// In a message whose field `front` it is.
Value message(const Image& image) {
  const Value inside{Value::Fields{{"height", {image.height}},
                                   {"width", {image.width}},
                                   {"encoding", {image.encoding}},
                                   {"is_bigendian", {std::uint64_t{image.big_endian}}},
                                   {"step", {image.step}},
                                   {"data", {image.data}}}};
  return Value{Value::Fields{{"front", inside}}};
}

Expected<Bytes> file_of(const Image& image) {
  return picture_file(message(image), *FieldPath::parse("front.data"));
}

/// The largest mean difference of a colour, of 255, from what was shown.
double difference(const Image& image, const cv::Mat& rgb) {
  const auto file = file_of(image);
  if (!file) return 1000;
  const auto seen = PictureDecoder().decode(*file);
  if (!seen || seen->size.width != rgb.cols || seen->size.height != rgb.rows) return 2000;
  const cv::Mat ours(rgb.rows, rgb.cols, CV_8UC3, const_cast<std::uint8_t*>(seen->bytes.data()));
  cv::Mat apart;
  cv::absdiff(ours, rgb, apart);
  const cv::Scalar mean = cv::mean(apart);
  return std::max({mean[0], mean[1], mean[2]});
}

TEST(RawPictures, OfWholePixelsAreExact) {
  const cv::Mat rgb = shades();
  const auto converted = [&](int code) {
    cv::Mat made;
    cv::cvtColor(rgb, made, code);
    return made;
  };
  EXPECT_EQ(difference(padded(rgb, "rgb8"), rgb), 0);
  EXPECT_EQ(difference(padded(converted(cv::COLOR_RGB2BGR), "bgr8"), rgb), 0);
  EXPECT_EQ(difference(padded(converted(cv::COLOR_RGB2BGR), "8UC3"), rgb), 0);
  EXPECT_EQ(difference(padded(converted(cv::COLOR_RGB2RGBA), "rgba8"), rgb), 0);
  EXPECT_EQ(difference(padded(converted(cv::COLOR_RGB2BGRA), "bgra8"), rgb), 0);
}

TEST(RawPictures, GreyOnesAreGrey) {
  cv::Mat grey, rgb, wide;
  cv::cvtColor(shades(), grey, cv::COLOR_RGB2GRAY);
  cv::cvtColor(grey, rgb, cv::COLOR_GRAY2RGB);
  grey.convertTo(wide, CV_16U, 257);
  EXPECT_LT(difference(padded(grey, "mono8"), rgb), 1);
  EXPECT_LT(difference(padded(grey, "8UC1"), rgb), 1);
  Image image = padded(wide, "mono16");
  EXPECT_LT(difference(image, rgb), 1.1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto at = static_cast<std::size_t>(y * (2 * width + 5) + 2 * x);
      image.data[at] = 255;  // the low byte first; a reader of the wrong order sees white
      std::swap(image.data[at], image.data[at + 1]);
    }
  image.big_endian = true;
  EXPECT_LT(difference(image, rgb), 1.1);
}

TEST(RawPictures, PairsAndSquaresOfPixelsShowTheColours) {
  const cv::Mat rgb = shades();
  // The letters name the first two rows from the top left.
  for (const std::string order : {"rggb", "bggr", "gbrg", "grbg"}) {
    cv::Mat mosaic(height, width, CV_8UC1);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const char colour = order[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
        const int channel = colour == 'r' ? 0 : colour == 'g' ? 1 : 2;
        mosaic.at<std::uint8_t>(y, x) = rgb.at<cv::Vec3b>(y, x)[channel];
      }
    EXPECT_LT(difference(padded(mosaic, "bayer_" + order + "8"), rgb), 6) << order;
  }
  cv::Mat yuv;
  cv::cvtColor(rgb, yuv, cv::COLOR_RGB2YUV);
  cv::Mat uyvy(height, width, CV_8UC2), yuyv(height, width, CV_8UC2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const cv::Vec3b right = rgb.at<cv::Vec3b>(y, x), pair = rgb.at<cv::Vec3b>(y, x - x % 2);
      const auto clamped = [](double v) { return cv::saturate_cast<std::uint8_t>(v); };
      // ITU-R BT.601, of narrow range.
      const std::uint8_t luma =
          clamped(16 + 0.257 * right[0] + 0.504 * right[1] + 0.098 * right[2]);
      const std::uint8_t colour =
          x % 2 == 0 ? clamped(128 - 0.148 * pair[0] - 0.291 * pair[1] + 0.439 * pair[2])
                     : clamped(128 + 0.439 * pair[0] - 0.368 * pair[1] - 0.071 * pair[2]);
      uyvy.at<cv::Vec2b>(y, x) = {colour, luma};
      yuyv.at<cv::Vec2b>(y, x) = {luma, colour};
    }
  for (const char* name : {"yuv422", "uyvy"}) EXPECT_LT(difference(padded(uyvy, name), rgb), 4);
  for (const char* name : {"yuv422_yuy2", "yuyv"})
    EXPECT_LT(difference(padded(yuyv, name), rgb), 4);
}

TEST(RawPictures, WhatIsNotThereIsNotRead) {
  const auto why = [](auto change) {
    Image image = padded(shades(), "rgb8");
    change(image);
    const auto file = file_of(image);
    return file ? "taken" : file.error().what;
  };
  const std::string bytes = "has not the bytes that its width, height and step tell";
  EXPECT_EQ(why([](Image& i) { i.data.clear(); }), "is no picture");
  EXPECT_EQ(why([](Image& i) { i.data.pop_back(); }), bytes);
  EXPECT_EQ(why([](Image& i) { i.height = 1e19; }), bytes);
  EXPECT_EQ(why([](Image& i) { i.height = -1; }), bytes);
  EXPECT_EQ(why([](Image& i) { i.step = std::nan(""); }), bytes);
  EXPECT_THAT(why([](Image& i) { i.encoding = "16UC1"; }), HasSubstr("«16UC1»"));
}

TEST(RawPictures, WhateverIsBesideTheBytesIsRefusedOrShown) {
  Random random(7);
  int shown = 0;
  for (int n = 0; n < 2000; ++n) {
    static const std::array<const char*, 6> names{"rgb8",   "mono16", "bayer_gbrg8",
                                                  "yuv422", "rgba8",  "8UC1"};
    Image image{double(random.index(12)), double(random.index(12)),
                double(random.index(50)), names[random.index(names.size())],
                random.index(2) == 0,     Bytes(random.index(400), 77)};
    const auto file = file_of(image);
    if (!file) continue;
    const auto seen = PictureDecoder().decode(*file);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->size.width, image.width);
    EXPECT_EQ(seen->size.height, image.height);
    ++shown;
  }
  EXPECT_GT(shown, 100);
}

}  // namespace
}  // namespace prehend::recorder::dataset
