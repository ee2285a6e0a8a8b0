#pragma once

#include <Eigen/Core>
#include <prehend/recognition_picture/picture.hpp>
#include <vector>

namespace prehend::recognition {

/// A step from a pixel to its partner, px.
struct Offset {
  int dx = 0, dy = 0;
};

/// Offsets of half a plane (a pair counts once) at four directions and these distances, px.
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

/// Cooccurrence counts of square cells of a picture, kept so that the histogram of any rectangle of
/// cells is a sum. A pair belongs to the cell of its first pixel; its second must be in the
/// picture. Pixels whose colour is not below the size of the palette belong to no pair.
class CellGrid {
 public:
  /// `step`: only every step-th pixel in both directions is the first of a pair.
  CellGrid(const Plane& colours, int palette_size, const std::vector<Offset>& offsets,
           int cell_size, int step);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int cell_size() const { return cell_size_; }
  int bins() const { return bins_; }

  /// Histograms of all windows of `size` by `size` cells whose first cell lies at a multiple of
  /// `stride`, row by row from the top left, as columns. Running sums: the cost does not grow with
  /// the window.
  Eigen::MatrixXf windows(int size, int stride) const;
  /// The histogram of the whole picture.
  Eigen::VectorXf total() const;

 private:
  const std::uint16_t* cell(int x, int y) const {
    return &counts_[static_cast<std::size_t>(y * columns_ + x) * static_cast<std::size_t>(bins_)];
  }

  int columns_ = 0, rows_ = 0, cell_size_ = 0, bins_ = 0;
  std::vector<std::uint16_t> counts_;
};

}  // namespace prehend::recognition
