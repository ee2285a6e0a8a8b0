// Pictures and lenses are what their types in idl/ros2 say, and come back as they went.
#include "common/ros2/pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "tests/support/ros_values.hpp"

namespace prehend::ros2 {
namespace {

using test::count;
using test::in;
using test::list;
using test::number;
using test::ros_value;
using test::text;
using test::Value;

TEST(Ros2Pictures, PicturesStayTheirBytes) {
  const std::vector<std::uint8_t> data{0xff, 0xd8, 0, 1, 2};
  const Value message = ros_value("sensor_msgs::msg::dds_::CompressedImage_",
                                  compressed_image({1, "camera", "jpeg", data}));
  EXPECT_EQ(text(message, {"format_"}), "jpeg");
  EXPECT_EQ(text(message, {"header_", "frame_id_"}), "camera");
  EXPECT_EQ(std::get<std::vector<std::uint8_t>>(in(message, {"data_"}).content), data);
}

TEST(Ros2Pictures, TheLensIsThatOfOpenCv) {
  const Lens lens{.width = 640,
                  .height = 480,
                  .fx = 620,
                  .fy = 621,
                  .cx = 319,
                  .cy = 239,
                  .distortion = {1, 2, 3, 4, 5}};
  const Value message =
      ros_value("sensor_msgs::msg::dds_::CameraInfo_", camera_info(1, "camera", lens));
  EXPECT_EQ(count(message, {"width_"}), 640U);
  EXPECT_EQ(count(message, {"height_"}), 480U);
  EXPECT_EQ(text(message, {"distortion_model_"}), "plumb_bob");
  EXPECT_EQ(number(list(message, {"d_"}).at(4)), 5);
  const auto& k = list(message, {"k_"});
  EXPECT_EQ(number(k[0]), 620);
  EXPECT_EQ(number(k[2]), 319);
  EXPECT_EQ(number(k[4]), 621);
  EXPECT_EQ(number(k[5]), 239);
  EXPECT_EQ(number(list(message, {"p_"})[6]), 239);
  EXPECT_FALSE(std::get<bool>(in(message, {"roi_", "do_rectify_"}).content));
}

TEST(Ros2Pictures, ComeBackAsTheyWent) {
  const CompressedPicture picture{7, "camera", "jpeg", {1, 2, 3}};
  const auto read = parse_compressed_image(compressed_image(picture));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(read->stamp_ns, 7);
  EXPECT_EQ(read->format, "jpeg");
  EXPECT_EQ(read->data, picture.data);
  const Lens lens{640, 480, 620, 621, 319, 239, {1, 2, 3, 4, 5}};
  const auto info = parse_camera_info(camera_info(7, "camera", lens));
  ASSERT_TRUE(info) << info.error().what;
  EXPECT_EQ(info->width, 640U);
  EXPECT_EQ(info->fy, 621);
  EXPECT_EQ(info->cy, 239);
  EXPECT_EQ(info->distortion, lens.distortion);
}

Bytes raw_image(std::uint8_t big_endian) {
  CdrWriter made;
  made.stamp(7);
  made.put(std::string_view("camera"));
  made.put(std::uint32_t{2});
  made.put(std::uint32_t{3});
  made.put(std::string_view("mono8"));
  made.put(big_endian);
  made.put(std::uint32_t{4});
  made.put(std::vector<std::uint8_t>{1, 2, 3, 0, 4, 5, 6, 0});
  return std::move(made).bytes();
}

TEST(Ros2Pictures, RawOnesAreWhatTheirTypeSays) {
  const Bytes bytes = raw_image(1);
  const Value message = ros_value("sensor_msgs::msg::dds_::Image_", bytes);
  const auto read = parse_image(bytes);
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(read->stamp_ns, 7);
  EXPECT_EQ(read->frame, text(message, {"header_", "frame_id_"}));
  EXPECT_EQ(read->encoding, text(message, {"encoding_"}));
  EXPECT_EQ(read->width, count(message, {"width_"}));
  EXPECT_EQ(read->height, count(message, {"height_"}));
  EXPECT_EQ(read->step, count(message, {"step_"}));
  EXPECT_EQ(read->data, std::get<std::vector<std::uint8_t>>(in(message, {"data_"}).content));
  EXPECT_EQ(read->width, 3U);
  EXPECT_TRUE(read->big_endian);
  EXPECT_FALSE(parse_image(raw_image(0))->big_endian);
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(parse_image(std::span(bytes).first(n))) << n;
}

TEST(Ros2Pictures, WhatIsNoneIsRefused) {
  const Bytes whole = compressed_image({7, "camera", "jpeg", {1, 2, 3}});
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_FALSE(parse_compressed_image(std::span(whole).first(n))) << n;
  EXPECT_FALSE(parse_camera_info(std::span(whole)));
  const Lens wrong{640, 480, std::numeric_limits<double>::quiet_NaN(), 1, 2, 3, {}};
  EXPECT_EQ(parse_camera_info(camera_info(7, "camera", wrong)).error().what,
            "has values that are no numbers");
  Bytes fish = camera_info(7, "camera", {640, 480, 1, 1, 2, 3, {}});
  const std::string_view known = "plumb_bob", other = "fish_eyes";
  const auto at = std::search(fish.begin(), fish.end(), known.begin(), known.end());
  ASSERT_NE(at, fish.end());
  std::copy(other.begin(), other.end(), at);
  EXPECT_EQ(parse_camera_info(fish).error().message(),
            "has the distortion model «fish_eyes» (plumb_bob is understood)");
}

}  // namespace
}  // namespace prehend::ros2
