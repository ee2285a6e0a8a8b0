#include "services/recognition/core/placing/fitting_image.hpp"

#include "services/recognition/core/placing/colour_bins.hpp"

namespace prehend::recognition {

FittingImage prepare(const Picture& picture, const Palette& palette) {
  FittingImage frame{
      picture, palette.quantise(picture), Plane(picture.width, picture.height), {}, {}, {}};
  frame.bins.resize(picture.pixels());
  frame.bin_share = Eigen::VectorXf::Zero(bin_count);
  frame.colour_share = Eigen::VectorXf::Zero(palette.size());
  for (std::size_t i = 0; i < frame.bins.size(); ++i) {
    const std::uint8_t* p = &picture.rgb[3 * i];
    const int bin =
        (p[0] >> 4) * bins_a_channel * bins_a_channel + (p[1] >> 4) * bins_a_channel + (p[2] >> 4);
    frame.bins[i] = static_cast<std::uint16_t>(bin);
    frame.bin_share[bin] += 1;
  }
  add_shadows(frame.bin_share);
  smooth(frame.bin_share);
  // The same in colours of the palette.
  Picture every_bin(bin_count, 1);
  for (int i = 0; i < bin_count; ++i) {
    std::uint8_t* p = every_bin.at(i, 0);
    p[0] = static_cast<std::uint8_t>(i / (bins_a_channel * bins_a_channel) * 16 + 8);
    p[1] = static_cast<std::uint8_t>(i / bins_a_channel % bins_a_channel * 16 + 8);
    p[2] = static_cast<std::uint8_t>(i % bins_a_channel * 16 + 8);
  }
  const Plane of_bin = palette.quantise(every_bin);
  for (int i = 0; i < bin_count; ++i) frame.colour_share[of_bin.at(i, 0)] += frame.bin_share[i];
  return frame;
}

}  // namespace prehend::recognition
