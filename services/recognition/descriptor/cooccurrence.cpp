#include "cooccurrence.hpp"

#include <algorithm>

namespace prehend::recognition {

std::vector<Offset> offsets_at(const std::vector<int>& distances) {
  std::vector<Offset> made;
  for (const int d : distances) {
    const int diagonal = std::max(1, static_cast<int>(d * 0.7071 + 0.5));
    made.push_back({d, 0});
    made.push_back({0, d});
    made.push_back({diagonal, diagonal});
    made.push_back({-diagonal, diagonal});
  }
  return made;
}

Eigen::VectorXf cooccurrence(const Plane& colours, int palette_size,
                             const std::vector<Offset>& offsets, const Plane& mask) {
  Eigen::VectorXf made = Eigen::VectorXf::Zero(pair_count(palette_size));
  for (const Offset& offset : offsets) {
    const int from = std::max(0, -offset.dx), to = colours.width - std::max(0, offset.dx);
    for (int y = 0; y + offset.dy < colours.height; ++y)
      for (int x = from; x < to; ++x) {
        if (!mask.at(x, y) || !mask.at(x + offset.dx, y + offset.dy)) continue;
        made[pair_index(colours.at(x, y), colours.at(x + offset.dx, y + offset.dy))] += 1;
      }
  }
  return made;
}

CellGrid::CellGrid(const Plane& colours, int palette_size, const std::vector<Offset>& offsets,
                   int cell_size, int step)
    : columns_(colours.width / cell_size),
      rows_(colours.height / cell_size),
      cell_size_(cell_size),
      bins_(pair_count(palette_size)),
      counts_(static_cast<std::size_t>(columns_ * rows_) * static_cast<std::size_t>(bins_), 0) {
  std::vector<std::uint16_t> pair(static_cast<std::size_t>(palette_size * palette_size));
  for (int a = 0; a < palette_size; ++a)
    for (int b = 0; b < palette_size; ++b)
      pair[static_cast<std::size_t>(a * palette_size + b)] =
          static_cast<std::uint16_t>(pair_index(a, b));
  const int height = rows_ * cell_size, width = columns_ * cell_size;
  for (const Offset& offset : offsets)
    for (int y = 0; y < std::min(height, colours.height - offset.dy); y += step) {
      const std::uint8_t* first = &colours.values[colours.index(0, y)];
      const std::uint8_t* second = &colours.values[colours.index(0, y + offset.dy)];
      std::uint16_t* row = counts_.data() + static_cast<std::size_t>(y / cell_size * columns_) *
                                                static_cast<std::size_t>(bins_);
      for (int x = 0; x < width; x += step) {
        const int partner = x + offset.dx;
        if (partner < 0 || partner >= colours.width) continue;
        if (first[x] >= palette_size || second[partner] >= palette_size) continue;
        ++row[(x / cell_size) * bins_ +
              pair[static_cast<std::size_t>(first[x] * palette_size + second[partner])]];
      }
    }
}

Eigen::MatrixXf CellGrid::windows(int size, int stride) const {
  const int across = columns_ < size ? 0 : (columns_ - size) / stride + 1;
  const int down = rows_ < size ? 0 : (rows_ - size) / stride + 1;
  Eigen::MatrixXf made(bins_, across * down);
  // Sums over `size` rows of every column, then over `size` columns; both slide.
  using Counts = Eigen::Array<std::int32_t, Eigen::Dynamic, 1>;
  using Cell = Eigen::Map<const Eigen::Array<std::uint16_t, Eigen::Dynamic, 1>>;
  std::vector<Counts> column(static_cast<std::size_t>(columns_), Counts::Zero(bins_));
  int filled = 0;  // rows [filled - size, filled) are summed
  for (int j = 0; j < down; ++j) {
    for (; filled < j * stride + size; ++filled)
      for (int x = 0; x < columns_; ++x) {
        Counts& sum = column[static_cast<std::size_t>(x)];
        sum += Cell(cell(x, filled), bins_).cast<std::int32_t>();
        if (filled >= size) sum -= Cell(cell(x, filled - size), bins_).cast<std::int32_t>();
      }
    Counts window = Counts::Zero(bins_);
    int covered = 0;
    for (int i = 0; i < across; ++i) {
      for (; covered < i * stride + size; ++covered) {
        window += column[static_cast<std::size_t>(covered)];
        if (covered >= size) window -= column[static_cast<std::size_t>(covered - size)];
      }
      made.col(j * across + i) = window.cast<float>();
    }
  }
  return made;
}

Eigen::VectorXf CellGrid::total() const {
  Eigen::VectorXf sum = Eigen::VectorXf::Zero(bins_);
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x)
      sum += Eigen::Map<const Eigen::Matrix<std::uint16_t, Eigen::Dynamic, 1>>(cell(x, y), bins_)
                 .cast<float>();
  return sum;
}

}  // namespace prehend::recognition
