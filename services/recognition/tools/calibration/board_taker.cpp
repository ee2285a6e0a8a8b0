#include "services/recognition/tools/calibration/board_taker.hpp"

#include <algorithm>
#include <array>

namespace prehend::recognition {
namespace {

/// Mean distance of the corners of two views, px.
double apart(const BoardView& a, const BoardView& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).norm();
  return sum / static_cast<double>(a.size());
}

/// The part of the picture in which the fewest corners were seen.
std::string emptiest(const std::vector<BoardView>& views, const Picture& picture) {
  static constexpr std::array<const char*, 9> names{
      "at the upper left", "at the top",    "at the upper right",
      "at the left",       "in the middle", "at the right",
      "at the lower left", "at the bottom", "at the lower right"};
  std::array<int, 9> count{};
  for (const BoardView& view : views)
    for (const Eigen::Vector2d& p : view) {
      const int x = std::clamp(static_cast<int>(3 * p.x() / picture.width), 0, 2);
      const int y = std::clamp(static_cast<int>(3 * p.y() / picture.height), 0, 2);
      ++count[static_cast<std::size_t>(3 * y + x)];
    }
  return names[static_cast<std::size_t>(std::min_element(count.begin(), count.end()) -
                                        count.begin())];
}

}  // namespace

bool BoardTaker::see(const Picture& picture) {
  if (done()) return false;
  const auto view = find_chessboard(picture, board_);
  if (!view) {
    hint_ = "the board is not wholly and clearly in sight";
    last_.clear();
    return false;
  }
  const double unit = picture.width;
  still_ = !last_.empty() && apart(*view, last_) < 0.002 * unit ? still_ + 1 : 0;
  last_ = *view;
  const bool fresh = std::all_of(views_.begin(), views_.end(), [&](const BoardView& before) {
    return apart(*view, before) > 0.06 * unit;
  });
  if (!fresh) {
    hint_ = "show the board slanted " + emptiest(views_, picture);
    return false;
  }
  if (still_ < 2) {
    hint_ = "keep it still";
    return false;
  }
  views_.push_back(*view);
  still_ = 0;
  hint_ = done() ? "" : "show the board slanted " + emptiest(views_, picture);
  return true;
}

}  // namespace prehend::recognition
