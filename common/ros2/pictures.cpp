#include "common/ros2/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/printable.hpp"

namespace prehend::ros2 {

Bytes compressed_image(const CompressedPicture& picture) {
  CdrWriter made;
  made.stamp(picture.stamp_ns);
  made.put(picture.frame);
  made.put(picture.format);
  made.put(picture.data);
  return std::move(made).bytes();
}

Expected<CompressedPicture> parse_compressed_image(std::span<const std::uint8_t> bytes) {
  CdrReader read(bytes);
  CompressedPicture made;
  made.stamp_ns = read.stamp();
  made.frame = read.text();
  made.format = read.text();
  made.data = read.bytes();
  if (!read.good()) return fail("is no whole sensor_msgs/CompressedImage", {}, type_hint);
  return made;
}

Expected<RawPicture> parse_image(std::span<const std::uint8_t> bytes) {
  CdrReader read(bytes);
  RawPicture made;
  made.stamp_ns = read.stamp();
  made.frame = read.text();
  made.height = read.count();
  made.width = read.count();
  made.encoding = read.text();
  made.big_endian = read.byte() != 0;
  made.step = read.count();
  made.data = read.bytes();
  if (!read.good()) return fail("is no whole sensor_msgs/Image", {}, type_hint);
  return made;
}

Bytes camera_info(std::int64_t stamp_ns, std::string_view frame, const Lens& lens) {
  CdrWriter made;
  made.stamp(stamp_ns);
  made.put(frame);
  made.put(lens.height);
  made.put(lens.width);
  made.put(std::string_view("plumb_bob"));
  made.put(lens.distortion);
  made.put(std::array<double, 9>{lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1});
  made.put(std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  made.put(std::array<double, 12>{lens.fx, 0, lens.cx, 0, 0, lens.fy, lens.cy, 0, 0, 0, 1, 0});
  for (int i = 0; i < 6; ++i) made.put(std::uint32_t{0});  // no binning, no region of interest
  made.put(std::uint8_t{0});
  return std::move(made).bytes();
}

Expected<Lens> parse_camera_info(std::span<const std::uint8_t> bytes) {
  CdrReader read(bytes);
  Lens made;
  (void)read.stamp();
  (void)read.text();
  made.height = read.count();
  made.width = read.count();
  const std::string model = read.text();
  made.distortion = read.reals();
  std::array<double, 9> k{};
  for (double& value : k) value = read.real();
  if (!read.good()) return fail("is no whole sensor_msgs/CameraInfo", {}, type_hint);
  if (!model.empty() && model != "plumb_bob")
    return fail("has the distortion model «" + printable(model.substr(0, 64)) + "»", {},
                "plumb_bob is understood");
  made.distortion.resize(5);
  const auto is_number = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(k, is_number) || !std::ranges::all_of(made.distortion, is_number))
    return fail("has values that are no numbers");
  made.fx = k[0];
  made.cx = k[2];
  made.fy = k[4];
  made.cy = k[5];
  return made;
}

}  // namespace prehend::ros2
