#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// A step from a pixel to its partner, px.
struct Offset {
  int dx = 0, dy = 0;
};

/// Offsets of half a plane (a pair counts once) at four directions and these distances, px. At
/// distance 0 a pixel is its own partner: a plain colour histogram.
std::vector<Offset> offsets_at(const std::vector<int>& distances);

/// Index of the unordered pair of colours {a, b} among pair_count(colours) ones.
inline int pair_index(int a, int b) {
  const int low = a < b ? a : b, high = a < b ? b : a;
  return high * (high + 1) / 2 + low;
}
inline int pair_count(int colours) {
  return colours * (colours + 1) / 2;
}

/// Colour cooccurrence histogram (Chang and Krumm 1999): how often two colours lie at one of the
/// offsets from each other, over all pairs whose two pixels both lie in the mask. Not normalised.
Eigen::VectorXf cooccurrence(const Plane& colours, int palette_size,
                             const std::vector<Offset>& offsets, const Plane& mask);

}  // namespace prehend::recognition
