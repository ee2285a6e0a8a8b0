#include "services/recognition/tools/evaluation/judged.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::recognition {

std::vector<std::vector<int>> confusion(std::span<const Judged> pictures, std::size_t classes) {
  std::vector<std::vector<int>> made(classes, std::vector<int>(classes, 0));
  for (const Judged& picture : pictures)
    if (picture.truth >= 0 && picture.best >= 0)
      ++made[static_cast<std::size_t>(picture.truth)][static_cast<std::size_t>(picture.best)];
  return made;
}

double threshold_for(std::span<const Judged> pictures, double share) {
  std::vector<double> known;
  for (const Judged& picture : pictures)
    if (picture.truth >= 0) known.push_back(picture.probability);
  if (known.empty()) return 0;
  std::sort(known.rbegin(), known.rend());
  const auto last = static_cast<std::size_t>(std::ceil(share * static_cast<double>(known.size())));
  return known[std::clamp<std::size_t>(last, 1, known.size()) - 1];
}

Accepted accept(std::span<const Judged> pictures, double threshold) {
  Accepted made;
  for (const Judged& picture : pictures) {
    const bool through = picture.best >= 0 && picture.probability >= threshold;
    if (picture.truth < 0) {
      ++made.strangers;
      made.strangers_rejected += !through;
      continue;
    }
    ++made.known;
    made.known_accepted += through;
    made.wrong_accepted += through && !picture.right();
  }
  return made;
}

std::vector<Bin> reliability(std::span<const Judged> pictures) {
  std::vector<Bin> made(10);
  for (const Judged& picture : pictures) {
    Bin& bin = made[std::min<std::size_t>(9, static_cast<std::size_t>(10 * picture.probability))];
    bin.said += picture.probability;
    bin.held += picture.right();
    ++bin.count;
  }
  for (Bin& bin : made) {
    const auto n = static_cast<double>(std::max<std::size_t>(1, bin.count));
    bin.said /= n;
    bin.held /= n;
  }
  return made;
}

double brier(std::span<const Judged> pictures) {
  double sum = 0;
  for (const Judged& picture : pictures)
    sum += std::pow(picture.probability - (picture.right() ? 1 : 0), 2);
  return pictures.empty() ? 0 : sum / static_cast<double>(pictures.size());
}

}  // namespace prehend::recognition
