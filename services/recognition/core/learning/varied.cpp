#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

Picture varied(const Picture& picture, Random& random) {
  const double zoom = std::exp(random.uniform(-0.3, 0.3));
  const double gain = std::exp(random.uniform(-0.4, 0.25));
  std::array<double, 3> channel;
  for (double& c : channel) c = gain * std::exp(random.uniform(-0.08, 0.08));
  const double shift_x = random.uniform(-0.04, 0.04) * picture.width;
  const double shift_y = random.uniform(-0.04, 0.04) * picture.height;
  // A pixel outside is the one that a mirror at the edge would show.
  const auto inside = [](int i, int size) {
    const int period = 2 * size;
    const int k = ((i % period) + period) % period;
    return k < size ? k : period - 1 - k;
  };
  Picture made(picture.width, picture.height);
  for (int y = 0; y < made.height; ++y)
    for (int x = 0; x < made.width; ++x) {
      const double u = (x + 0.5 - shift_x - made.width / 2.0) / zoom + made.width / 2.0 - 0.5;
      const double v = (y + 0.5 - shift_y - made.height / 2.0) / zoom + made.height / 2.0 - 0.5;
      const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
      const int x0 = inside(left, made.width), x1 = inside(left + 1, made.width);
      const int y0 = inside(top, made.height), y1 = inside(top + 1, made.height);
      const double a = u - left, b = v - top;
      for (std::size_t c = 0; c < 3; ++c) {
        const double upper = (1 - a) * picture.at(x0, y0)[c] + a * picture.at(x1, y0)[c];
        const double lower = (1 - a) * picture.at(x0, y1)[c] + a * picture.at(x1, y1)[c];
        made.at(x, y)[c] = static_cast<std::uint8_t>(
            std::clamp(channel[c] * ((1 - b) * upper + b * lower), 0.0, 255.0));
      }
    }
  return made;
}

Plane part_of(const Plane& mask, Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi), share = random.uniform(0.2, 0.45);
  const auto along = [&](int x, int y) { return x * std::cos(angle) + y * std::sin(angle); };
  std::vector<double> places;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (mask.at(x, y)) places.push_back(along(x, y));
  Plane made = mask;
  if (places.empty()) return made;
  const auto edge =
      places.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(places.size()));
  std::nth_element(places.begin(), edge, places.end());
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (along(x, y) < *edge) made.at(x, y) = 0;
  return made;
}

}  // namespace prehend::recognition
