#include "services/recognition/core/placing/evidence.hpp"

#include <algorithm>

namespace prehend::recognition {

double Evidence::at(int x, int y) const {
  if (x < left_ || y < top_ || x >= left_ + width_ || y >= top_ + height_) return 0;
  const double* row =
      &sums_[static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(width_ + 1)];
  return row[x - left_ + 1] - row[x - left_];
}

double Evidence::sum(const Silhouette& region) const {
  double total = 0;
  for (std::size_t i = 0; i < region.rows.size(); ++i) {
    const int y = region.top + static_cast<int>(i) - top_;
    if (y < 0 || y >= height_) continue;
    const int from = std::clamp(region.rows[i].left - left_, 0, width_);
    const int to = std::clamp(region.rows[i].right - left_, 0, width_);
    if (to <= from) continue;
    const double* row = &sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1)];
    total += row[to] - row[from];
  }
  return total;
}

}  // namespace prehend::recognition
