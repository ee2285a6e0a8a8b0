#include "services/recognition/core/detection/movement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/recognition/core/picture/difference.hpp"

namespace prehend::recognition {
namespace {

std::size_t place(int x, int y, int width) {
  return 3 * (static_cast<std::size_t>(y / 2) * static_cast<std::size_t>((width + 1) / 2) +
              static_cast<std::size_t>(x / 2));
}

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void Movement::start(const Picture& picture) {
  const bool known = width_ == picture.width && height_ == picture.height;
  if (known) ++relearned_;
  all_new_ = true;
  width_ = picture.width;
  height_ = picture.height;
  background_.resize(place(0, height_ + 1, width_));
  for (int y = 0; y < height_; y += 2)
    for (int x = 0; x < width_; x += 2)
      std::copy_n(picture.at(x, y), 3, &background_[place(x, y, width_)]);
  const int side = options_.cell_size;
  differs_ = Plane((width_ + side - 1) / side, (height_ + side - 1) / side, 1);
}

const Plane& Movement::look(const Picture& picture) {
  all_new_ = false;
  if (picture.empty()) return differs_;
  if (picture.width != width_ || picture.height != height_) {
    start(picture);
    return differs_;
  }
  // The light: for each channel the middle one of the ratios of the cells.
  const int side = options_.cell_size;
  std::array<std::vector<float>, 3> ratios;
  for (int top = 0; top < height_; top += side)
    for (int left = 0; left < width_; left += side) {
      std::array<float, 3> now{}, before{};
      for (int y = top; y < std::min(top + side, height_); y += 4)
        for (int x = left; x < std::min(left + side, width_); x += 4)
          for (std::size_t c = 0; c < 3; ++c) {
            now[c] += static_cast<float>(picture.at(x / 2 * 2, y / 2 * 2)[c]);
            before[c] += background_[place(x, y, width_) + c];
          }
      for (std::size_t c = 0; c < 3; ++c) ratios[c].push_back((now[c] + 1) / (before[c] + 1));
    }
  std::array<float, 3> gain;
  for (std::size_t c = 0; c < 3; ++c) gain[c] = std::clamp(median(ratios[c]), 0.4f, 2.5f);
  const bool other =
      std::any_of(gain.begin(), gain.end(), [](float g) { return std::abs(g - 1) > 0.005f; });
  if (other)
    for (std::size_t i = 0; i < background_.size(); ++i) background_[i] *= gain[i % 3];

  int cells = 0;
  for (int row = 0; row < differs_.height; ++row)
    for (int column = 0; column < differs_.width; ++column) {
      int count = 0, all = 0;
      for (int y = row * side; y < std::min((row + 1) * side, height_); y += 2)
        for (int x = column * side; x < std::min((column + 1) * side, width_); x += 2) {
          ++all;
          count += differs(picture.at(x / 2 * 2, y / 2 * 2), &background_[place(x, y, width_)],
                           static_cast<float>(options_.threshold));
        }
      const bool yes = count > options_.min_share * all;
      differs_.at(column, row) = yes;
      cells += yes;
    }
  if (cells > options_.relearn_share * static_cast<double>(differs_.values.size())) start(picture);
  return differs_;
}

void Movement::learn(const Picture& picture, const Plane& cells) {
  if (picture.width != width_ || picture.height != height_ || cells.width != differs_.width ||
      cells.height != differs_.height)
    return;
  const int side = options_.cell_size;
  const auto follow = static_cast<float>(options_.follow);
  for (int y = 0; y < height_; y += 2)
    for (int x = 0; x < width_; x += 2) {
      const int column = x / side, row = y / side;
      if (!cells.at(column, row)) continue;
      const float share = differs_.at(column, row) ? 1 : follow;
      const std::uint8_t* seen = picture.at(x, y);
      float* kept = &background_[place(x, y, width_)];
      for (int c = 0; c < 3; ++c) kept[c] += share * (static_cast<float>(seen[c]) - kept[c]);
    }
}

}  // namespace prehend::recognition
