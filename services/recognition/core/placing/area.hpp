#pragma once

#include <algorithm>
#include <cstddef>

#include "services/recognition/core/geometry/silhouette.hpp"

namespace prehend::recognition {

/// The rectangle of a picture in which a shape is looked for, px; right and bottom exclusive.
struct Area {
  int left = 0, top = 0, right = 0, bottom = 0;

  int width() const { return right - left; }
  int height() const { return bottom - top; }
  bool holds(int x, int y) const { return x >= left && y >= top && x < right && y < bottom; }
  /// Of a pixel, in row by row order.
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - top) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - left);
  }
  /// Calls use(x, y) for the region's pixels that lie in it.
  template <class Use>
  void visit(const Silhouette& region, Use use) const {
    for (std::size_t i = 0; i < region.rows.size(); ++i) {
      const int y = region.top + static_cast<int>(i);
      if (y < top || y >= bottom) continue;
      const int end = std::min(right, region.rows[i].right);
      for (int x = std::max(left, region.rows[i].left); x < end; ++x) use(x, y);
    }
  }
};

}  // namespace prehend::recognition
