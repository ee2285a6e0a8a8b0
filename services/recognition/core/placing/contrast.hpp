#pragma once

#include <functional>

#include "services/recognition/core/geometry/silhouette.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// Share of an outline along which the colours on its two sides differ: near 1 where an object
/// stands, about a half where an outline merely lies over something. Places where either side is
/// not `usable` do not count; without any that does, one half. `polygon`: corners in order, px.
double outline_contrast(const Picture& picture, const std::vector<Eigen::Vector2d>& polygon,
                        const std::function<bool(int, int)>& usable);

}  // namespace prehend::recognition
