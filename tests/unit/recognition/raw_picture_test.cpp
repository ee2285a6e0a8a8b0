// Raw pictures of cameras: each encoding shows the same colours.
#include "services/recognition/cameras/raw_picture.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/base/random.hpp"

namespace prehend::recognition {
namespace {

using Colour = std::array<double, 3>;
constexpr int width = 32, height = 24;

/// Red grows to the right, green downwards.
Colour shade(int x, int y) {
  return {40.0 + 5 * x, 40.0 + 6 * y, 90};
}

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// Rows with bytes between them; pixel: what it adds for the one at x, y.
template <class Pixel>
ros2::RawPicture made(const std::string& encoding, const Pixel& pixel) {
  ros2::RawPicture raw;
  raw.encoding = encoding;
  raw.width = width;
  raw.height = height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) pixel(raw.data, x, y);
    raw.data.insert(raw.data.end(), 5, 255);
    raw.step = static_cast<std::uint32_t>(raw.data.size() / static_cast<std::size_t>(y + 1));
  }
  return raw;
}

/// Of whole pixels: of r, g, b and a (255), in this order.
ros2::RawPicture whole(const std::string& encoding, const std::string& order) {
  return made(encoding, [&](auto& data, int x, int y) {
    for (const char letter : order)
      data.push_back(letter == 'a' ? 255 : byte(shade(x, y)[std::string("rgb").find(letter)]));
  });
}

/// Mean difference of the worst colour from what was shown, of 255; grey: as its brightness.
double difference(const ros2::RawPicture& raw, bool grey = false) {
  const auto picture = picture_of(raw, "here");
  if (!picture || picture->width != width || picture->height != height) return 1000;
  Colour sum{};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Colour shown = shade(x, y);
      const double bright = 0.299 * shown[0] + 0.587 * shown[1] + 0.114 * shown[2];
      for (std::size_t i = 0; i < 3; ++i)
        sum[i] += std::abs(picture->at(x, y)[i] - (grey ? bright : shown[i]));
    }
  return *std::ranges::max_element(sum) / (width * height);
}

TEST(RawPicture, OfWholePixelsIsExact) {
  EXPECT_EQ(difference(whole("rgb8", "rgb")), 0);
  EXPECT_EQ(difference(whole("bgr8", "bgr")), 0);
  EXPECT_EQ(difference(whole("8UC3", "bgr")), 0);
  EXPECT_EQ(difference(whole("rgba8", "rgba")), 0);
  EXPECT_EQ(difference(whole("bgra8", "bgra")), 0);
}

TEST(RawPicture, GreyIsGrey) {
  const auto bright = [](int x, int y) {
    const Colour c = shade(x, y);
    return byte(0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]);
  };
  const auto narrow = [&](auto& data, int x, int y) { data.push_back(bright(x, y)); };
  EXPECT_LT(difference(made("mono8", narrow), true), 0.6);
  EXPECT_LT(difference(made("8UC1", narrow), true), 0.6);
  EXPECT_LT(difference(made("mono16",
                            [&](auto& data, int x, int y) {
                              data.insert(data.end(), {7, bright(x, y)});
                            }),
                       true),
            0.6);
  auto big = made("mono16", [&](auto& data, int x, int y) {
    data.insert(data.end(), {bright(x, y), 7});
  });
  big.big_endian = true;
  EXPECT_LT(difference(big, true), 0.6);
}

TEST(RawPicture, SquaresOfPixelsShowTheColours) {
  // The letters are the first two rows from the top left.
  for (const std::string order : {"rggb", "bggr", "gbrg", "grbg"})
    EXPECT_LT(difference(made("bayer_" + order + "8",
                              [&](auto& data, int x, int y) {
                                const char letter =
                                    order[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
                                data.push_back(byte(shade(x, y)[std::string("rgb").find(letter)]));
                              })),
              6)
        << order;
}

TEST(RawPicture, PairsOfPixelsShowTheColours) {
  // ITU-R BT.601, of narrow range.
  const auto luma = [](int x, int y) {
    const auto [r, g, b] = shade(x, y);
    return byte(16 + 0.257 * r + 0.504 * g + 0.098 * b);
  };
  const auto colour = [](int x, int y) {
    const auto [r, g, b] = shade(x - x % 2, y);
    return byte(x % 2 == 0 ? 128 - 0.148 * r - 0.291 * g + 0.439 * b
                           : 128 + 0.439 * r - 0.368 * g - 0.071 * b);
  };
  for (const char* name : {"yuv422", "uyvy"})
    EXPECT_LT(difference(made(name,
                              [&](auto& data, int x, int y) {
                                data.insert(data.end(), {colour(x, y), luma(x, y)});
                              })),
              4);
  for (const char* name : {"yuv422_yuy2", "yuyv"})
    EXPECT_LT(difference(made(name,
                              [&](auto& data, int x, int y) {
                                data.insert(data.end(), {luma(x, y), colour(x, y)});
                              })),
              4);
}

TEST(RawPicture, TooSmallAndTooLargeOnesAreRefused) {
  const auto why = [](auto change) {
    ros2::RawPicture raw = whole("rgb8", "rgb");
    change(raw);
    return picture_of(raw, "here").error().message();
  };
  EXPECT_EQ(why([](auto& raw) { raw.height = 7; }), "here: is smaller than 8 px");
  EXPECT_EQ(why([](auto& raw) { raw.width = 0x55555556; }),
            "here: has more than 40 million pixels (make it smaller)");
  EXPECT_EQ(why([](auto& raw) { raw.data.pop_back(); }),
            "here: has not the bytes that its width, height and step tell");
}

TEST(RawPicture, WhateverIsToldIsRefusedOrShown) {
  Random random(7);
  int shown = 0;
  for (int n = 0; n < 2000; ++n) {
    static const std::array<const char*, 6> names{"rgb8",   "mono16", "bayer_gbrg8",
                                                  "yuv422", "rgba8",  "8UC1"};
    ros2::RawPicture raw;
    raw.encoding = names[random.index(names.size())];
    raw.width = static_cast<std::uint32_t>(random.index(20));
    raw.height = static_cast<std::uint32_t>(random.index(20));
    raw.step = static_cast<std::uint32_t>(random.index(60));
    raw.data.assign(random.index(1000), 77);
    const auto picture = picture_of(raw, "here");
    if (!picture) continue;
    EXPECT_EQ(picture->pixels(), raw.width * raw.height);
    ++shown;
  }
  EXPECT_GT(shown, 50);
}

}  // namespace
}  // namespace prehend::recognition
