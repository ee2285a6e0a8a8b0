#include "services/recognition/tools/taking/view_taker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/recognition/core/picture/difference.hpp"

namespace prehend::recognition {
namespace {

constexpr int table_pictures = 5;  // summed for the empty table
constexpr int rest_pictures = 3;   // alike in a row: it rests
constexpr int above_noise = 28;    // grey levels: above noise and jpeg
constexpr double moved_share = 0.003;
constexpr int margin = 12;  // px around the object

/// Share of the pixels (every second, both ways) of which a channel changed.
double changed(const Picture& a, const Picture& b) {
  std::size_t count = 0, all = 0;
  for (int y = 0; y < a.height; y += 2)
    for (int x = 0; x < a.width; x += 2) {
      const std::uint8_t *p = a.at(x, y), *q = b.at(x, y);
      ++all;
      for (int c = 0; c < 3; ++c)
        if (std::abs(p[c] - q[c]) > above_noise) {
          ++count;
          break;
        }
    }
  return static_cast<double>(count) / static_cast<double>(all);
}

}  // namespace

bool ViewTaker::rests(const Picture& picture) {
  still_ = changed(picture, before_) < moved_share ? still_ + 1 : 0;
  before_ = picture;
  return still_ >= rest_pictures;
}

/// True when the table is known.
bool ViewTaker::learn_table(const Picture& picture) {
  if (empty_ >= table_pictures) return true;
  if (!rests(picture)) {
    std::fill(table_.begin(), table_.end(), 0.f);
    empty_ = 0;
    return false;
  }
  for (std::size_t i = 0; i < table_.size(); ++i)
    table_[i] += static_cast<float>(picture.rgb[i]) / table_pictures;
  if (++empty_ == table_pictures) {
    hint_ = "put the object on the table and take the hand away";
    taken_ = picture;
    still_ = 0;
  }
  return false;
}

bool ViewTaker::see(const Picture& picture) {
  if (picture.empty() || done()) return false;
  if (picture.width != before_.width || picture.height != before_.height) {
    *this = ViewTaker(wanted_);
    before_ = picture;
    table_.assign(picture.rgb.size(), 0.f);
    return false;
  }
  if (!learn_table(picture) || !rests(picture)) return false;

  cv::Mat fresh(picture.height, picture.width, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (differs(picture.at(x, y), &table_[3 * picture.index(x, y)], above_noise))
        fresh.at<std::uint8_t>(y, x) = 255;
  const auto square = [](int side) {
    return cv::getStructuringElement(cv::MORPH_RECT, cv::Size(side, side));
  };
  cv::morphologyEx(fresh, fresh, cv::MORPH_OPEN, square(3));
  cv::morphologyEx(fresh, fresh, cv::MORPH_CLOSE, square(9));
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(fresh, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto area = [](const auto& outline) { return cv::contourArea(outline); };
  const auto largest =
      std::max_element(outlines.begin(), outlines.end(),
                       [&](const auto& a, const auto& b) { return area(a) < area(b); });
  if (largest == outlines.end() || area(*largest) < 300) {
    hint_ = "put the object on the table and take the hand away";
    return false;
  }
  double others = -area(*largest);
  for (const auto& outline : outlines) others += area(outline);
  const cv::Rect box = cv::boundingRect(*largest);
  if (box.x == 0 || box.y == 0 || box.br().x == picture.width || box.br().y == picture.height) {
    hint_ = "take the hand away; the object must be in the picture as a whole";
    return false;
  }
  if (others > 0.3 * area(*largest)) {
    hint_ = "there is more than one thing that was not there before";
    return false;
  }
  Plane mask(picture.width, picture.height);
  cv::Mat filled(picture.height, picture.width, CV_8UC1, mask.values.data());
  cv::drawContours(filled, outlines, static_cast<int>(largest - outlines.begin()), cv::Scalar(1),
                   cv::FILLED);
  return take(picture, mask, box.x, box.y, box.width, box.height);
}

bool ViewTaker::take(const Picture& picture, const Plane& mask, int left, int top, int width,
                     int height) {
  const int x0 = std::max(0, left - margin), x1 = std::min(picture.width, left + width + margin);
  const int y0 = std::max(0, top - margin), y1 = std::min(picture.height, top + height + margin);
  double difference = 0;  // mean over the object of what the last view did not show
  std::size_t pixels = 0;
  TrainingView view{Picture(x1 - x0, y1 - y0), Plane(x1 - x0, y1 - y0)};
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const std::uint8_t *p = picture.at(x, y), *q = taken_.at(x, y);
      std::copy_n(p, 3, view.picture.at(x - x0, y - y0));
      view.mask.at(x - x0, y - y0) = mask.at(x, y);
      if (!mask.at(x, y)) continue;
      ++pixels;
      for (int c = 0; c < 3; ++c) difference += std::abs(p[c] - q[c]) / 3.0;
    }
  hint_ = "turn it a little, or move it, and take the hand away";
  if (difference < 8.0 * static_cast<double>(pixels)) return false;
  taken_ = picture;
  views_.push_back(std::move(view));
  return true;
}

}  // namespace prehend::recognition
