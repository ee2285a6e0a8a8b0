#include "services/recognition/core/placing/contrast.hpp"

#include <cmath>

namespace prehend::recognition {
namespace {

constexpr double apart = 2.5;  // px from the outline to each side; lens and pixels blur it by one
constexpr double step = 2;     // px along the outline
constexpr int clear = 12;      // grey levels: four sigma of the noise of a difference

/// The pixel nearest to p, none outside the picture or where it is not usable.
const std::uint8_t* at(const Picture& picture, const std::function<bool(int, int)>& usable,
                       const Eigen::Vector2d& p) {
  const int x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return nullptr;
  return usable(x, y) ? picture.at(x, y) : nullptr;
}

}  // namespace

double outline_contrast(const Picture& picture, const std::vector<Eigen::Vector2d>& polygon,
                        const std::function<bool(int, int)>& usable) {
  int all = 0, differ = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i], along = polygon[(i + 1) % polygon.size()] - a;
    const double length = along.norm();
    if (!(length > 0) || length > 1e5) continue;
    const Eigen::Vector2d across = apart / length * Eigen::Vector2d(-along.y(), along.x());
    for (double t = step / 2; t < length; t += step) {
      const Eigen::Vector2d p = a + t / length * along;
      const std::uint8_t* one = at(picture, usable, p + across);
      const std::uint8_t* other = at(picture, usable, p - across);
      if (!one || !other) continue;
      int most = 0;
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(int{one[c]} - int{other[c]}));
      ++all;
      differ += most > clear;
    }
  }
  return all > 0 ? static_cast<double>(differ) / all : 0.5;
}

}  // namespace prehend::recognition
