#pragma once

#include <vector>

#include "services/recognition/core/geometry/silhouette.hpp"

namespace prehend::recognition {

/// A map of log likelihood ratios over a rectangle of the picture, as running sums of each row.
class Evidence {
 public:
  Evidence(int left, int top, int width, int height)
      : left_(left),
        top_(top),
        width_(width),
        height_(height),
        sums_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height)) {}

  template <class Value>
  void fill(Value value) {
    for (int y = 0; y < height_; ++y) {
      double* row = &sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1)];
      row[0] = 0;
      for (int x = 0; x < width_; ++x) row[x + 1] = row[x] + value(left_ + x, top_ + y);
    }
  }
  /// Of one pixel; 0 outside the rectangle.
  double at(int x, int y) const;
  /// Over a region; what lies outside the rectangle counts nothing.
  double sum(const Silhouette& region) const;

 private:
  int left_, top_, width_, height_;
  std::vector<double> sums_;
};

}  // namespace prehend::recognition
