#include "services/recognition/core/placing/colour_bins.hpp"

namespace prehend::recognition {
namespace {

constexpr int side = bins_a_channel;

}  // namespace

void smooth(Eigen::VectorXf& bins) {
  for (const int stride : {1, side, side * side}) {
    const Eigen::VectorXf before = bins;
    for (int i = 0; i < bin_count; ++i) {
      const int place = i / stride % side;
      const float low = place > 0 ? before[i - stride] : before[i];
      const float high = place < side - 1 ? before[i + stride] : before[i];
      bins[i] = 0.25f * low + 0.5f * before[i] + 0.25f * high;
    }
  }
  const float sum = bins.sum();
  if (sum > 0) bins /= sum;
}

void add_shadows(Eigen::VectorXf& bins) {
  constexpr float share = 0.06f;  // of the surface for each depth of shadow
  const Eigen::VectorXf lit = bins;
  for (int i = 0; i < bin_count; ++i) {
    if (!(lit[i] > 0)) continue;
    const Eigen::Array3f colour(static_cast<float>(i / (side * side)) + 0.5f,
                                static_cast<float>(i / side % side) + 0.5f,
                                static_cast<float>(i % side) + 0.5f);
    for (const float darker : {0.9f, 0.82f, 0.74f, 0.66f, 0.58f, 0.5f}) {
      const Eigen::Array3i dark = (colour * darker).cast<int>();
      bins[dark[0] * side * side + dark[1] * side + dark[2]] += share * lit[i];
    }
  }
  const float sum = bins.sum();
  if (sum > 0) bins /= sum;
}

}  // namespace prehend::recognition
