#pragma once

#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

/// A small picture of a checked thing in two colours before a plain, noisy background: enough to
/// learn from in no time.
inline TrainingView painted(const Eigen::Vector3i& first, const Eigen::Vector3i& second,
                            const Eigen::Vector3i& background, int check, Random& random) {
  TrainingView made{Picture(48, 64), centred_mask(48, 64)};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 48; ++x) {
      const bool thing = made.mask.at(x, y) != 0;
      const Eigen::Vector3i& colour =
          !thing ? background : ((x / check + y / check) % 2 == 0 ? first : second);
      for (int c = 0; c < 3; ++c)
        made.picture.at(x, y)[c] = static_cast<std::uint8_t>(
            std::clamp(colour[c] + static_cast<int>(random.index(17)) - 8, 0, 255));
    }
  return made;
}

/// Three things, each before `backgrounds` different backgrounds, three views of each.
inline std::vector<TrainingClass> painted_classes(int backgrounds, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Eigen::Vector3i> behind = {
      {200, 190, 60}, {40, 60, 150}, {128, 128, 128}, {90, 160, 90}, {230, 230, 230}};
  const std::vector<std::pair<Eigen::Vector3i, Eigen::Vector3i>> things = {
      {{210, 40, 40}, {240, 240, 240}},
      {{40, 170, 60}, {30, 30, 30}},
      {{40, 70, 200}, {230, 210, 60}}};
  std::vector<TrainingClass> made;
  for (std::size_t i = 0; i < things.size(); ++i) {
    made.push_back({"thing " + std::to_string(i), {}});
    for (int b = 0; b < backgrounds; ++b)
      for (int k = 0; k < 3; ++k)
        made.back().views.push_back(painted(things[i].first, things[i].second,
                                            behind[static_cast<std::size_t>(b)], 3 + k, random));
  }
  return made;
}

inline Classification named(const ObjectModels& models, const TrainingView& view) {
  return classify(models, describe(models, models.palette.quantise(view.picture), view.mask));
}

}  // namespace prehend::recognition
