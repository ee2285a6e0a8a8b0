#include "services/recognition/tools/calibration/chessboard.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace prehend::recognition {
namespace {

/// Mean brightness of a few pixels around a point; none outside the picture.
std::optional<double> brightness(const cv::Mat& grey, const cv::Point2f& at) {
  const cv::Rect spot(static_cast<int>(std::lround(at.x)) - 1,
                      static_cast<int>(std::lround(at.y)) - 1, 3, 3);
  if ((spot & cv::Rect(0, 0, grey.cols, grey.rows)) != spot) return std::nullopt;
  return cv::mean(grey(spot))[0];
}

/// Turns the corners so that the square outside of the first one is the dark one.
bool put_dark_first(const cv::Mat& grey, const Chessboard& board,
                    std::vector<cv::Point2f>& corners) {
  const auto at = [&](int row, int column) {
    return corners[static_cast<std::size_t>(row * board.columns + column)];
  };
  // Middle of a corner square: half a diagonal outwards from the inner corner.
  const auto middle = [](const cv::Point2f& corner, const cv::Point2f& inwards) {
    return corner - 0.5f * (inwards - corner);
  };
  const auto first = brightness(grey, middle(at(0, 0), at(1, 1)));
  const auto last = brightness(
      grey, middle(at(board.rows - 1, board.columns - 1), at(board.rows - 2, board.columns - 2)));
  if (!first || !last || std::abs(*first - *last) < 15) return false;
  if (*first > *last) std::reverse(corners.begin(), corners.end());
  return true;
}

}  // namespace

Expected<Chessboard> checked_board(const Chessboard& board) {
  if (board.columns < 3 || board.rows < 3 || board.columns > 50 || board.rows > 50)
    return fail("needs 3 to 50 inner corners each way", "chessboard");
  if ((board.columns + board.rows) % 2 == 0)
    return fail("looks the same upside down", "chessboard",
                "take one with an odd number of inner corners one way and an even one the other");
  if (!(board.square >= 0.001 && board.square <= 1))
    return fail("squares must measure 1 mm to 1 m", "chessboard", "the side is given in metres");
  return board;
}

std::optional<std::vector<Eigen::Vector2d>> find_chessboard(const Picture& picture,
                                                            const Chessboard& board) {
  if (picture.width < 32 || picture.height < 32) return std::nullopt;
  const cv::Mat rgb(picture.height, picture.width, CV_8UC3,
                    const_cast<std::uint8_t*>(picture.rgb.data()));
  cv::Mat grey;
  std::vector<cv::Point2f> corners;
  try {
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    if (!cv::findChessboardCorners(
            grey, {board.columns, board.rows}, corners,
            cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK))
      return std::nullopt;
    // The window of the refinement must not reach the next corner.
    float nearest = 1e9f;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const cv::Point2f d = corners[i] - corners[i - 1];
      nearest = std::min(nearest, std::hypot(d.x, d.y));
    }
    const int reach = std::clamp(static_cast<int>(nearest / 3), 2, 8);
    cv::cornerSubPix(grey, corners, {reach, reach}, {-1, -1},
                     {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 0.005});
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  // Rows turn to columns clockwise as the picture shows it (x right, y down, z away): a board is
  // never seen from behind.
  const auto columns = static_cast<std::ptrdiff_t>(board.columns);
  const cv::Point2f x = corners[1] - corners[0];
  const cv::Point2f y = corners[static_cast<std::size_t>(columns)] - corners[0];
  if (x.x * y.y - x.y * y.x < 0)
    for (auto row = corners.begin(); row != corners.end(); row += columns)
      std::reverse(row, row + columns);
  if (!put_dark_first(grey, board, corners)) return std::nullopt;
  std::vector<Eigen::Vector2d> made;
  for (const cv::Point2f& corner : corners) made.push_back({corner.x, corner.y});
  return made;
}

}  // namespace prehend::recognition
