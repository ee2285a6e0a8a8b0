#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/recognition/core/descriptor/palette.hpp"

namespace prehend::recognition {

/// A picture prepared for fitting shapes into it.
struct FittingImage {
  Picture picture;
  Plane colours;                    // palette indices
  Plane taken;                      // 1: already explained by another object
  std::vector<std::uint16_t> bins;  // fine RGB bin of every pixel
  Eigen::VectorXf bin_share;        // of the whole picture, smoothed
  Eigen::VectorXf colour_share;     // of the palette's colours in the whole picture
};
FittingImage prepare(const Picture& picture, const Palette& palette);

}  // namespace prehend::recognition
