#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/recognition/core/descriptor/cooccurrence.hpp"

namespace prehend::recognition {

/// Cooccurrence histograms of all rectangles of cells of a picture, by a summed-area table with one
/// layer a bin: four reads a bin, however large the rectangle. 16 bits suffice although the sums
/// over the picture overflow them: differences are right modulo 2^16.
/// A pair belongs to the cell of its first pixel; its second must be in the picture. Pixels whose
/// colour is not below the size of the palette belong to no pair.
class WindowSums {
 public:
  /// `step`: only every step-th pixel in both directions is the first of a pair. It is raised until
  /// a window of `largest` by `largest` cells cannot hold more than 65,535 pairs.
  WindowSums(const Plane& colours, int palette_size, const std::vector<Offset>& offsets,
             int cell_size, int step, int largest);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int bins() const { return bins_; }
  /// Numbers a histogram takes: the bins and zeros up to a multiple of 16.
  int padded() const { return padded_; }

  /// Adds up the window of `size` by `size` cells whose first cell is (column, row) into `counts`
  /// (padded() numbers); returns the number of pairs.
  std::uint32_t window(int column, int row, int size, std::span<std::uint16_t> counts) const;
  /// The histogram of the whole picture.
  Eigen::VectorXf total() const { return total_; }

 private:
  const std::uint16_t* corner(int column, int row) const {
    return &sums_[static_cast<std::size_t>(row * (columns_ + 1) + column) *
                  static_cast<std::size_t>(padded_)];
  }

  int columns_, rows_, bins_, padded_;
  std::vector<std::uint16_t> sums_;  // of the cells above and to the left of each corner
  Eigen::VectorXf total_;
};

}  // namespace prehend::recognition
