#include "services/recognition/core/learning/folds.hpp"

#include <algorithm>
#include <limits>

#include "common/base/random.hpp"

namespace prehend::recognition {
namespace {

constexpr double border_share = 0.15;

bool in_border(const Picture& picture, int x, int y) {
  const int across = static_cast<int>(border_share * picture.width);
  const int down = static_cast<int>(border_share * picture.height);
  return x < across || y < down || x >= picture.width - across || y >= picture.height - down;
}

/// Square roots of the shares of the colours in the border of each picture, as columns.
Eigen::MatrixXf borders(const std::vector<const Picture*>& pictures) {
  const ColourSpace space{.brightness_weight = 0.5};
  Random random(7);
  std::vector<Eigen::Vector3f> samples;
  for (const Picture* picture : pictures)
    for (int i = 0; i < 60 && !picture->empty(); ++i) {
      const std::uint8_t* p = &picture->rgb[3 * random.index(picture->pixels())];
      samples.push_back(colour_feature(space, p[0], p[1], p[2]));
    }
  const Palette palette = Palette::learn(space, samples, 32, 1);
  Eigen::MatrixXf made =
      Eigen::MatrixXf::Zero(palette.size(), static_cast<Eigen::Index>(pictures.size()));
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Plane colours = palette.quantise(*pictures[i]);
    auto column = made.col(static_cast<Eigen::Index>(i));
    for (int y = 0; y < colours.height; ++y)
      for (int x = 0; x < colours.width; ++x)
        if (in_border(*pictures[i], x, y)) column[colours.at(x, y)] += 1;
    column = (column / std::max(1.f, column.sum())).cwiseSqrt().eval();
  }
  return made;
}

}  // namespace

std::vector<int> ward(const Eigen::MatrixXf& columns, int clusters) {
  struct Cluster {
    Eigen::VectorXf centre;
    std::vector<Eigen::Index> members;
  };
  std::vector<Cluster> left;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) left.push_back({columns.col(i), {i}});
  while (left.size() > static_cast<std::size_t>(std::max(1, clusters))) {
    float least = std::numeric_limits<float>::max();
    std::size_t first = 0, second = 1;
    for (std::size_t a = 0; a < left.size(); ++a)
      for (std::size_t b = a + 1; b < left.size(); ++b) {
        const auto m = static_cast<float>(left[a].members.size());
        const auto n = static_cast<float>(left[b].members.size());
        const float cost = (left[a].centre - left[b].centre).squaredNorm() * m * n / (m + n);
        if (cost >= least) continue;
        least = cost;
        first = a;
        second = b;
      }
    Cluster &kept = left[first], &joined = left[second];
    const auto m = static_cast<float>(kept.members.size());
    const auto n = static_cast<float>(joined.members.size());
    kept.centre = (m * kept.centre + n * joined.centre) / (m + n);
    kept.members.insert(kept.members.end(), joined.members.begin(), joined.members.end());
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(second));
  }
  std::vector<int> made(static_cast<std::size_t>(columns.cols()));
  for (std::size_t c = 0; c < left.size(); ++c)
    for (const Eigen::Index i : left[c].members)
      made[static_cast<std::size_t>(i)] = static_cast<int>(c);
  return made;
}

std::vector<int> folds_by_background(const std::vector<TrainingClass>& classes, int folds) {
  std::vector<const Picture*> pictures;
  for (const TrainingClass& c : classes)
    for (const TrainingView& view : c.views) pictures.push_back(&view.picture);
  const Eigen::MatrixXf all = borders(pictures);
  std::vector<int> made;
  std::vector<std::size_t> load(static_cast<std::size_t>(folds), 0);  // views of all classes so far
  Eigen::Index begin = 0;
  for (const TrainingClass& c : classes) {
    const auto count = static_cast<Eigen::Index>(c.views.size());
    const std::vector<int> group = ward(all.middleCols(begin, count), folds);
    begin += count;
    std::vector<std::pair<std::size_t, int>> sizes;  // and the group's number
    for (int g = 0; g < folds; ++g)
      sizes.push_back({static_cast<std::size_t>(std::count(group.begin(), group.end(), g)), g});
    std::sort(sizes.rbegin(), sizes.rend());
    std::vector<std::size_t> own(load.size(), 0);
    std::vector<int> fold_of(sizes.size());
    for (const auto& [size, g] : sizes) {
      std::size_t best = 0;
      for (std::size_t f = 1; f < own.size(); ++f)
        if (std::pair(own[f], load[f]) < std::pair(own[best], load[best])) best = f;
      fold_of[static_cast<std::size_t>(g)] = static_cast<int>(best);
      own[best] += size;
      load[best] += size;
    }
    for (const int g : group) made.push_back(fold_of[static_cast<std::size_t>(g)]);
  }
  return made;
}

}  // namespace prehend::recognition
