#include "services/recognition/core/scan/window_sums.hpp"

#include <algorithm>

namespace prehend::recognition {

WindowSums::WindowSums(const Plane& colours, int palette_size, const std::vector<Offset>& offsets,
                       int cell_size, int step, int largest)
    : columns_(colours.width / cell_size),
      rows_(colours.height / cell_size),
      bins_(pair_count(palette_size)),
      padded_((bins_ + 15) / 16 * 16),
      sums_(static_cast<std::size_t>((columns_ + 1) * (rows_ + 1)) *
                static_cast<std::size_t>(padded_),
            0),
      total_(Eigen::VectorXf::Zero(bins_)) {
  const auto pairs = [&] {
    const int firsts = (cell_size + step - 1) / step * largest;
    return static_cast<std::size_t>(firsts * firsts) * offsets.size();
  };
  while (pairs() > 65535) ++step;

  std::vector<std::uint16_t> pair(static_cast<std::size_t>(palette_size * palette_size));
  for (int a = 0; a < palette_size; ++a)
    for (int b = 0; b < palette_size; ++b)
      pair[static_cast<std::size_t>(a * palette_size + b)] =
          static_cast<std::uint16_t>(pair_index(a, b));
  const auto stored = static_cast<std::size_t>(padded_);
  const auto line = static_cast<std::size_t>(columns_ + 1) * stored;
  // Each cell counts at the corner below and to the right of it.
  const int height = rows_ * cell_size, width = columns_ * cell_size;
  for (int y = 0; y < height; y += step) {
    std::uint16_t* row = &sums_[static_cast<std::size_t>(y / cell_size + 1) * line];
    const std::uint8_t* first = &colours.values[colours.index(0, y)];
    for (const Offset& offset : offsets) {
      if (y + offset.dy >= colours.height) continue;
      const std::uint8_t* second = &colours.values[colours.index(0, y + offset.dy)] + offset.dx;
      // The first multiple of step whose partner is in the picture.
      int x = offset.dx < 0 ? (-offset.dx + step - 1) / step * step : 0;
      const int end = std::min(width, colours.width - std::max(0, offset.dx));
      while (x < end) {
        const int column = x / cell_size, edge = std::min(end, (column + 1) * cell_size);
        std::uint16_t* cell = row + static_cast<std::size_t>(column + 1) * stored;
        for (; x < edge; x += step)
          if (first[x] < palette_size && second[x] < palette_size)
            ++cell[pair[static_cast<std::size_t>(first[x] * palette_size + second[x])]];
      }
    }
  }
  for (int y = 1; y <= rows_; ++y) {
    std::uint16_t* row = &sums_[static_cast<std::size_t>(y) * line];
    for (int x = 1; x <= columns_; ++x)
      for (int b = 0; b < bins_; ++b)
        total_[b] += row[static_cast<std::size_t>(x) * stored + static_cast<std::size_t>(b)];
    for (std::size_t i = stored; i < line; ++i)
      row[i] = static_cast<std::uint16_t>(row[i] + row[i - stored]);
    for (std::size_t i = 0; i < line; ++i)
      row[i] = static_cast<std::uint16_t>(row[i] + row[i - line]);
  }
}

std::uint32_t WindowSums::window(int column, int row, int size,
                                 std::span<std::uint16_t> counts) const {
  const std::uint16_t* a = corner(column, row);
  const std::uint16_t* b = corner(column + size, row);
  const std::uint16_t* c = corner(column, row + size);
  const std::uint16_t* d = corner(column + size, row + size);
  std::uint32_t pairs = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = static_cast<std::uint16_t>(a[i] - b[i] - c[i] + d[i]);
    pairs += counts[i];
  }
  return pairs;
}

}  // namespace prehend::recognition
