#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <prehend/recognition_picture/picture.hpp>
#include <vector>

namespace prehend::recognition {

/// The plane in which colours are told apart: chromaticity r = R/(R+G+B), g = G/(R+G+B), which
/// light changes little, and brightness with a small weight, which tells white from black. Dark
/// pixels have no reliable chromaticity and are drawn towards grey.
struct ColourSpace {
  double brightness_weight = 0.25;  // of (R+G+B)/765 against the chromaticities
  double dark = 12;                 // grey levels that a pixel needs to have a colour
};
Eigen::Vector3f colour_feature(const ColourSpace& space, std::uint8_t r, std::uint8_t g,
                               std::uint8_t b);

/// A set of colours, and the nearest of them for every pixel by table (5 bits a channel).
class Palette {
 public:
  static constexpr int max_colours = 64;

  /// Centres found by k-means++ and Lloyd's iterations over colour features. Fewer than `colours`
  /// when there are not that many different features.
  static Palette learn(const ColourSpace& space, const std::vector<Eigen::Vector3f>& features,
                       int colours, std::uint64_t seed);
  Palette(const ColourSpace& space, std::vector<Eigen::Vector3f> centres);

  int size() const { return static_cast<int>(centres_.size()); }
  const std::vector<Eigen::Vector3f>& centres() const { return centres_; }
  const ColourSpace& space() const { return space_; }
  int nearest(const Eigen::Vector3f& feature) const;
  Plane quantise(const Picture& picture) const;

 private:
  ColourSpace space_;
  std::vector<Eigen::Vector3f> centres_;
  std::vector<std::uint8_t> table_;  // 32^3
};

}  // namespace prehend::recognition
