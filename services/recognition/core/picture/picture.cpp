#include "services/recognition/core/picture/picture.hpp"

#include <algorithm>

namespace prehend::recognition {

Plane crop(const Plane& plane, int left, int top, int width, int height) {
  Plane made(width, height);
  for (int y = 0; y < height; ++y)
    std::copy_n(&plane.values[plane.index(left, top + y)], width, &made.values[made.index(0, y)]);
  return made;
}

}  // namespace prehend::recognition
