#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace prehend::recognition {

/// A shadow has this share of the background's brightness or more.
inline constexpr float darkest_shadow = 0.45f;

/// True when a pixel shows something before the background: a channel differs by more than
/// `threshold` (grey levels), and it is not the background in a shadow, which has the same colour
/// and is darker.
inline bool differs(const std::uint8_t* seen, const float* background, float threshold) {
  float most = 0, along = 0, squares = 0;
  for (int c = 0; c < 3; ++c) {
    const auto value = static_cast<float>(seen[c]);
    most = std::max(most, std::abs(value - background[c]));
    along += value * background[c];
    squares += background[c] * background[c];
  }
  if (most <= threshold) return false;
  // What remains when the background is scaled to a shadow is noise.
  const float share = squares > 0 ? along / squares : 0;
  if (share >= 1 || share < darkest_shadow) return true;
  float rest = 0;
  for (int c = 0; c < 3; ++c)
    rest = std::max(rest, std::abs(static_cast<float>(seen[c]) - share * background[c]));
  return rest > 0.5f * threshold;
}

}  // namespace prehend::recognition
