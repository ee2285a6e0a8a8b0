#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// A printed chessboard. Frame B: origin at the first inner corner, x along a row of inner corners,
/// y along a column, z into the board. The first inner corner is the one whose outer neighbour, the
/// board's corner square, is dark; so one number must be odd and the other even, else the board
/// looks the same upside down.
struct Chessboard {
  int columns = 9, rows = 6;  // inner corners, where four squares meet
  double square = 0.025;      // m, side of a square
};
Expected<Chessboard> checked_board(const Chessboard& board);

/// The inner corners in the picture, px to a fraction of one, row by row from the first; none when
/// the board is not wholly and clearly in sight. Corner k lies at
/// (k % columns, k / columns, 0) * square in B.
std::optional<std::vector<Eigen::Vector2d>> find_chessboard(const Picture& picture,
                                                            const Chessboard& board);

}  // namespace prehend::recognition
