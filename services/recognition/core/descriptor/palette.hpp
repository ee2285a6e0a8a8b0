#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// What is done about the colour of the light before anything else: nothing, or every channel is
/// scaled so that the picture's mean (grey world) or its 6-norm (shades of grey; Finlayson and
/// Trezzi 2004) is grey. For pictures of whole scenes; a picture that one
/// object fills has no light to estimate.
enum class Constancy { none, grey_world, shades_of_grey };

/// Where colours are told apart. Chromaticity: r = R/(R+G+B), g = G/(R+G+B), which light changes
/// little, and brightness with a small weight, which tells white from black; dark pixels have no
/// reliable chromaticity and are drawn towards grey. Lab: CIE L*a*b* (D65) over 100, L* weighted.
enum class Colours { chromaticity, lab };
struct ColourSpace {
  double brightness_weight = 0.25;  // of (R+G+B)/765 or L*/100 against the colour
  double dark = 12;                 // grey levels that a pixel needs to have a chromaticity
  Constancy constancy = Constancy::none;
  Colours colours = Colours::chromaticity;
};
Eigen::Vector3f colour_feature(const ColourSpace& space, std::uint8_t r, std::uint8_t g,
                               std::uint8_t b);

/// The picture as the space's constancy sees it.
Picture balanced(const Picture& picture, Constancy constancy);

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
  /// The nearest colour of each pixel, after the space's constancy.
  Plane quantise(const Picture& picture) const;

 private:
  Plane look_up(const Picture& picture) const;

  ColourSpace space_;
  std::vector<Eigen::Vector3f> centres_;
  std::vector<std::uint8_t> table_;  // 32^3
};

}  // namespace prehend::recognition
