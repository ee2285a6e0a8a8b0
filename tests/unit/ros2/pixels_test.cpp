// What a message tells of a raw picture is believed only where its bytes are there.
#include "common/ros2/pixels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "common/base/random.hpp"

namespace prehend::ros2 {
namespace {

using ::testing::HasSubstr;

RawPicture picture(const std::string& encoding) {
  return {.encoding = encoding,
          .width = 30,
          .height = 20,
          .step = 125,
          .data = std::vector<std::uint8_t>(2500)};
}

TEST(Ros2Pixels, GreyOfTwoBytesKnowsWhichIsFirst) {
  RawPicture grey = picture("mono16"), colours = picture("bgr8");
  EXPECT_EQ(pixels_of(grey), Pixels::grey_low_first);
  grey.big_endian = colours.big_endian = true;
  EXPECT_EQ(pixels_of(grey), Pixels::grey_high_first);
  EXPECT_EQ(pixels_of(colours), Pixels::bgr);
}

TEST(Ros2Pixels, DepthAndUnknownOnesAreNamed) {
  for (const std::string encoding : {"16UC1", "32FC1", "nv21", ""}) {
    const auto pixels = pixels_of(picture(encoding), "here");
    ASSERT_FALSE(pixels) << encoding;
    EXPECT_THAT(pixels.error().message(), HasSubstr("here: has the encoding «" + encoding + "»"));
    EXPECT_THAT(pixels.error().message(), HasSubstr("mono8"));
  }
}

TEST(Ros2Pixels, WhatIsNotThereIsRefused) {
  const auto is_taken = [](const std::string& encoding, auto change) {
    RawPicture made = picture(encoding);
    change(made);
    return pixels_of(made).has_value();
  };
  const auto nothing = [](RawPicture&) {};
  EXPECT_TRUE(is_taken("rgba8", nothing));
  EXPECT_FALSE(is_taken("rgba8", [](RawPicture& p) { p.data.pop_back(); }));
  EXPECT_FALSE(is_taken("rgba8", [](RawPicture& p) { p.step = 119; }));
  EXPECT_TRUE(is_taken("rgba8", [](RawPicture& p) { p.step = 120; }));
  EXPECT_FALSE(is_taken("rgba8", [](RawPicture& p) { p.step = 0xffffffff; }));
  EXPECT_FALSE(is_taken("rgba8", [](RawPicture& p) { p.width = 0; }));
  EXPECT_FALSE(is_taken("rgba8", [](RawPicture& p) { p.height = 0; }));
  EXPECT_FALSE(is_taken("rgba8", [](RawPicture& p) { p.width = 0x40000001; }));
  EXPECT_FALSE(is_taken("mono8", [](RawPicture& p) {
    p.height = 16385, p.width = p.step = 1, p.data.resize(16385);
  }));
  EXPECT_FALSE(is_taken("mono8", [](RawPicture& p) {
    p.height = 1, p.step = 16 * 16384 + 1, p.data.resize(p.step);
  }));
  for (const char* cell : {"bayer_rggb8", "yuv422", "yuyv"}) {
    EXPECT_TRUE(is_taken(cell, nothing)) << cell;
    EXPECT_FALSE(is_taken(cell, [](RawPicture& p) { p.width = 29; })) << cell;
    EXPECT_FALSE(is_taken(cell, [](RawPicture& p) { p.height = 19; })) << cell;
  }
}

}  // namespace
}  // namespace prehend::ros2
