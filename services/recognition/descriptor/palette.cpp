#include "palette.hpp"

#include <algorithm>
#include <limits>
#include <prehend/base/random.hpp>

namespace prehend::recognition {

Eigen::Vector3f colour_feature(const ColourSpace& space, std::uint8_t r, std::uint8_t g,
                               std::uint8_t b) {
  const auto dark = static_cast<float>(space.dark);
  const float sum = static_cast<float>(r) + static_cast<float>(g) + static_cast<float>(b);
  const float norm = sum + 3 * dark;
  return {(static_cast<float>(r) + dark) / norm, (static_cast<float>(g) + dark) / norm,
          static_cast<float>(space.brightness_weight) * sum / 765.f};
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
