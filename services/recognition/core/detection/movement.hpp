#pragma once

#include <vector>

#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

struct MovementOptions {
  int cell_size = 10;      // px, side of the cells in which pixels are counted
  double threshold = 20;   // grey levels of 255 by which a pixel must differ from the background
  double min_share = 0.1;  // of a cell's pixels, for the cell to differ
  double relearn_share = 0.5;  // of the cells: more that differ are no movement but another light
  double follow = 0.06;  // share of the new picture in the background where it does not differ
};

/// A stored background and what differs from it [Thesis, 3.4.3]. The background is what has been
/// looked at: whoever examined a place says so with `learn`. Changes of the light that concern the
/// whole picture alike (exposure, colour of the lamp) are compensated; when most of the picture
/// differs all the same, the background is learned anew. Works on every second pixel.
class Movement {
 public:
  explicit Movement(const MovementOptions& options = {}) : options_(options) {}

  /// 1 for each cell that differs from the background. The first picture, one of another size and
  /// one in another light become the background and differ everywhere.
  const Plane& look(const Picture& picture);
  /// Cells of the last picture whose place in `cells` is 1 become the background.
  void learn(const Picture& picture, const Plane& cells);
  /// How often the background was learned anew, the first time not counted.
  int relearned() const { return relearned_; }
  /// True after a picture that became the background as a whole.
  bool all_new() const { return all_new_; }

 private:
  void start(const Picture& picture);

  MovementOptions options_;
  int width_ = 0, height_ = 0;     // px
  std::vector<float> background_;  // of every second pixel of every second row
  Plane differs_;
  int relearned_ = 0;
  bool all_new_ = false;
};

}  // namespace prehend::recognition
