#include "services/recognition/core/descriptor/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/random.hpp"

namespace prehend::recognition {

namespace {

/// sRGB to L*a*b* with the white point D65 (CIE 15, IEC 61966-2-1).
Eigen::Vector3d lab(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  const auto linear = [](std::uint8_t v) {
    const double x = v / 255.0;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  };
  const Eigen::Matrix3d to_xyz{
      {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
  const Eigen::Vector3d xyz = to_xyz * Eigen::Vector3d(linear(r), linear(g), linear(b));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f(xyz.x() / 0.9505), y = f(xyz.y()), z = f(xyz.z() / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

}  // namespace

Eigen::Vector3f colour_feature(const ColourSpace& space, std::uint8_t r, std::uint8_t g,
                               std::uint8_t b) {
  if (space.colours == Colours::lab) {
    const Eigen::Vector3d c = lab(r, g, b) / 100;
    return Eigen::Vector3d(c.y(), c.z(), space.brightness_weight * c.x()).cast<float>();
  }
  const auto dark = static_cast<float>(space.dark);
  const float sum = static_cast<float>(r) + static_cast<float>(g) + static_cast<float>(b);
  const float norm = sum + 3 * dark;
  return {(static_cast<float>(r) + dark) / norm, (static_cast<float>(g) + dark) / norm,
          static_cast<float>(space.brightness_weight) * sum / 765.f};
}

Picture balanced(const Picture& picture, Constancy constancy) {
  if (constancy == Constancy::none || picture.empty()) return picture;
  // How often each value occurs is all that a mean of any order needs.
  std::array<std::array<double, 256>, 3> count{};
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) ++count[i % 3][picture.rgb[i]];
  const double order = constancy == Constancy::grey_world ? 1 : 6;
  Eigen::Vector3d light = Eigen::Vector3d::Zero();
  for (Eigen::Index c = 0; c < 3; ++c) {
    for (std::size_t v = 0; v < 256; ++v)
      light[c] += count[static_cast<std::size_t>(c)][v] * std::pow(static_cast<double>(v), order);
    light[c] = std::max(1.0, std::pow(light[c] / static_cast<double>(picture.pixels()), 1 / order));
  }
  std::array<std::array<std::uint8_t, 256>, 3> table{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t v = 0; v < 256; ++v)
      table[c][v] = static_cast<std::uint8_t>(std::clamp(
          static_cast<double>(v) * light.mean() / light[static_cast<Eigen::Index>(c)], 0.0, 255.0));
  Picture made = picture;
  for (std::size_t i = 0; i < made.rgb.size(); ++i) made.rgb[i] = table[i % 3][made.rgb[i]];
  return made;
}

Palette Palette::learn(const ColourSpace& space, const std::vector<Eigen::Vector3f>& features,
                       int colours, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3f> centres;
  if (features.empty()) return Palette(space, {Eigen::Vector3f(1 / 3.f, 1 / 3.f, 0)});
  centres.push_back(features[random.index(features.size())]);
  std::vector<float> distance(features.size(), std::numeric_limits<float>::max());
  while (static_cast<int>(centres.size()) < std::min(colours, max_colours)) {
    double total = 0;
    for (std::size_t i = 0; i < features.size(); ++i) {
      distance[i] = std::min(distance[i], (features[i] - centres.back()).squaredNorm());
      total += distance[i];
    }
    if (total < 1e-9) break;
    double left = random.uniform(0, total);
    std::size_t chosen = 0;
    while (chosen + 1 < features.size() && (left -= distance[chosen]) > 0) ++chosen;
    centres.push_back(features[chosen]);
  }
  for (int iteration = 0; iteration < 12; ++iteration) {
    std::vector<Eigen::Vector3f> sum(centres.size(), Eigen::Vector3f::Zero());
    std::vector<float> count(centres.size(), 0);
    for (const Eigen::Vector3f& feature : features) {
      std::size_t best = 0;
      float least = std::numeric_limits<float>::max();
      for (std::size_t k = 0; k < centres.size(); ++k) {
        const float d = (feature - centres[k]).squaredNorm();
        if (d < least) {
          least = d;
          best = k;
        }
      }
      sum[best] += feature;
      count[best] += 1;
    }
    for (std::size_t k = 0; k < centres.size(); ++k)
      if (count[k] > 0) centres[k] = sum[k] / count[k];
  }
  return Palette(space, std::move(centres));
}

Palette::Palette(const ColourSpace& space, std::vector<Eigen::Vector3f> centres)
    : space_(space), centres_(std::move(centres)), table_(32 * 32 * 32) {
  for (unsigned r = 0; r < 32; ++r)
    for (unsigned g = 0; g < 32; ++g)
      for (unsigned b = 0; b < 32; ++b) {
        const auto middle = [](unsigned v) { return static_cast<std::uint8_t>(8 * v + 4); };
        table_[(r << 10) | (g << 5) | b] = static_cast<std::uint8_t>(
            nearest(colour_feature(space_, middle(r), middle(g), middle(b))));
      }
}

int Palette::nearest(const Eigen::Vector3f& feature) const {
  int best = 0;
  float least = std::numeric_limits<float>::max();
  for (std::size_t k = 0; k < centres_.size(); ++k) {
    const float d = (feature - centres_[k]).squaredNorm();
    if (d >= least) continue;
    least = d;
    best = static_cast<int>(k);
  }
  return best;
}

Plane Palette::quantise(const Picture& picture) const {
  if (space_.constancy != Constancy::none) {
    const Picture corrected = balanced(picture, space_.constancy);
    return look_up(corrected);
  }
  return look_up(picture);
}

Plane Palette::look_up(const Picture& picture) const {
  Plane made(picture.width, picture.height);
  const std::uint8_t* p = picture.rgb.data();
  for (std::uint8_t& value : made.values) {
    value = table_[(static_cast<unsigned>(p[0] >> 3) << 10) |
                   (static_cast<unsigned>(p[1] >> 3) << 5) | static_cast<unsigned>(p[2] >> 3)];
    p += 3;
  }
  return made;
}

}  // namespace prehend::recognition
