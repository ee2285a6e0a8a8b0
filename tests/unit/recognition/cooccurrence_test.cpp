// Histograms of a masked region against the definition of a colour cooccurrence histogram, written
// out naively. Counts are whole numbers below 2^24, so they must be equal exactly.
#include "services/recognition/core/descriptor/cooccurrence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.hpp"
#include "services/recognition/core/descriptor/palette.hpp"
#include "services/recognition/core/learning/object_models.hpp"

namespace prehend::recognition {
namespace {

constexpr int colours = 5;

Plane random_plane(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Plane made(width, height);
  for (auto& value : made.values) value = static_cast<std::uint8_t>(random.index(colours));
  return made;
}

TEST(Cooccurrence, MaskedCountsOnlyPairsInsideTheMask) {
  const Plane plane = random_plane(20, 20, 4);
  Plane mask(20, 20);
  for (int y = 5; y < 12; ++y)
    for (int x = 4; x < 15; ++x) mask.at(x, y) = 1;
  const auto offsets = offsets_at({1, 2});
  Eigen::VectorXf expected = Eigen::VectorXf::Zero(pair_count(colours));
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x)
      for (const Offset& o : offsets) {
        const int u = x + o.dx, v = y + o.dy;
        if (u < 0 || v < 0 || u >= 20 || v >= 20 || !mask.at(x, y) || !mask.at(u, v)) continue;
        expected[pair_index(plane.at(x, y), plane.at(u, v))] += 1;
      }
  EXPECT_EQ(cooccurrence(plane, colours, offsets, mask), expected);
}

TEST(Cooccurrence, PairsAreUnorderedAndNumberedWithoutGaps) {
  std::vector<int> seen(static_cast<std::size_t>(pair_count(9)), 0);
  for (int a = 0; a < 9; ++a)
    for (int b = 0; b < 9; ++b) {
      EXPECT_EQ(pair_index(a, b), pair_index(b, a));
      ++seen[static_cast<std::size_t>(pair_index(a, b))];
    }
  for (const int count : seen) EXPECT_GE(count, 1);
}

TEST(Palette, TellsItsOwnCentresApart) {
  Random random(5);
  std::vector<Eigen::Vector3f> features;
  for (int i = 0; i < 2000; ++i)
    features.push_back(colour_feature({}, static_cast<std::uint8_t>(random.index(256)),
                                      static_cast<std::uint8_t>(random.index(256)),
                                      static_cast<std::uint8_t>(random.index(256))));
  const Palette palette = Palette::learn({}, features, 32, 1);
  ASSERT_EQ(palette.size(), 32);
  for (int k = 0; k < 32; ++k)
    EXPECT_EQ(palette.nearest(palette.centres()[static_cast<std::size_t>(k)]), k);
}

TEST(Palette, OneColourGivesOneCentre) {
  const Palette palette = Palette::learn({}, {50, Eigen::Vector3f(0.3f, 0.3f, 0.1f)}, 16, 1);
  EXPECT_EQ(palette.size(), 1);
}

TEST(Descriptor, IsOfNormOneAndZeroForNothing) {
  const Eigen::VectorXf weights = Eigen::VectorXf::Ones(6);
  Eigen::VectorXf counts(6);
  counts << 4, 0, 1, 9, 0, 2;
  EXPECT_NEAR(descriptor(counts, weights).norm(), 1, 1e-6);
  // Bhattacharyya: with equal weights the dot product is the sum of roots of products of shares.
  Eigen::VectorXf other(6);
  other << 0, 3, 1, 4, 0, 0;
  double expected = 0;
  for (int i = 0; i < 6; ++i) expected += std::sqrt(counts[i] / 16. * other[i] / 8.);
  EXPECT_NEAR(descriptor(counts, weights).dot(descriptor(other, weights)), expected, 1e-6);
  EXPECT_EQ(descriptor(Eigen::VectorXf::Zero(6), weights).norm(), 0);
}

}  // namespace
}  // namespace prehend::recognition
