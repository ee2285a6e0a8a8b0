#include "services/recognition/core/descriptor/cooccurrence.hpp"

#include <algorithm>

namespace prehend::recognition {

std::vector<Offset> offsets_at(const std::vector<int>& distances) {
  std::vector<Offset> made;
  for (const int d : distances) {
    if (d == 0) {
      made.push_back({0, 0});
      continue;
    }
    const int diagonal = std::max(1, static_cast<int>(d * 0.7071 + 0.5));
    made.push_back({d, 0});
    made.push_back({0, d});
    made.push_back({diagonal, diagonal});
    made.push_back({-diagonal, diagonal});
  }
  return made;
}

Eigen::VectorXf cooccurrence(const Plane& colours, int palette_size,
                             const std::vector<Offset>& offsets, const Plane& mask) {
  Eigen::VectorXf made = Eigen::VectorXf::Zero(pair_count(palette_size));
  for (const Offset& offset : offsets) {
    const int from = std::max(0, -offset.dx), to = colours.width - std::max(0, offset.dx);
    for (int y = 0; y + offset.dy < colours.height; ++y)
      for (int x = from; x < to; ++x) {
        if (!mask.at(x, y) || !mask.at(x + offset.dx, y + offset.dy)) continue;
        made[pair_index(colours.at(x, y), colours.at(x + offset.dx, y + offset.dy))] += 1;
      }
  }
  return made;
}

}  // namespace prehend::recognition
