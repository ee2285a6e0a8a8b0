#pragma once

#include "services/recognition/core/placing/area.hpp"
#include "services/recognition/core/placing/fitting_image.hpp"

namespace prehend::recognition {

/// Finds what stands before an object: patches inside its outline in colours that it does not have,
/// which go on beyond the outline. `around`: the outline grown by some centimetres;
/// `known_colours`: share of each palette colour on the object. Returns a byte a pixel of the area,
/// 1 where something is in front; all 0 when that is too little to matter, or so much that it is
/// another object altogether.
std::vector<std::uint8_t> find_hidden(const FittingImage& frame, const Area& area,
                                      const Silhouette& inside, const Silhouette& around,
                                      const Eigen::VectorXf& known_colours);

}  // namespace prehend::recognition
