// The scan against its definition, written out naively. Sums of counts are whole numbers and must
// be equal exactly; scores are rounded to 16 bits, which moves none by more than a thousandth.
#include "services/recognition/core/scan/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/base/random.hpp"
#include "services/recognition/core/geometry/silhouette.hpp"
#include "services/recognition/core/scan/window_sums.hpp"
#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

constexpr int colour_count = 5;

/// All pairs whose first pixel lies in the rectangle, on every step-th pixel.
Eigen::VectorXf naive(const Plane& plane, int palette, const std::vector<Offset>& offsets, int left,
                      int top, int side, int step) {
  Eigen::VectorXf made = Eigen::VectorXf::Zero(pair_count(palette));
  for (int y = top; y < top + side; ++y)
    for (int x = left; x < left + side; ++x) {
      if (x % step != 0 || y % step != 0) continue;
      for (const Offset& o : offsets) {
        const int u = x + o.dx, v = y + o.dy;
        if (u < 0 || v < 0 || u >= plane.width || v >= plane.height) continue;
        if (plane.at(x, y) >= palette || plane.at(u, v) >= palette) continue;
        made[pair_index(plane.at(x, y), plane.at(u, v))] += 1;
      }
    }
  return made;
}

TEST(WindowSums, EqualNaiveOnes) {
  Random random(3);
  Plane plane(83, 61);
  for (auto& value : plane.values) value = static_cast<std::uint8_t>(random.index(colour_count));
  for (int i = 0; i < 200; ++i) plane.values[static_cast<std::size_t>(i * 17)] = 255;  // left out
  const auto offsets = offsets_at({1, 3, 6});
  for (const int step : {1, 2, 3}) {
    const WindowSums sums(plane, colour_count, offsets, 8, step, 3);
    std::vector<std::uint16_t> counts(static_cast<std::size_t>(sums.padded()));
    for (const int size : {1, 2, 3})
      for (int j = 0; j + size <= sums.rows(); ++j)
        for (int i = 0; i + size <= sums.columns(); ++i) {
          const auto expected = naive(plane, colour_count, offsets, 8 * i, 8 * j, 8 * size, step);
          EXPECT_EQ(sums.window(i, j, size, counts), expected.sum());
          for (Eigen::Index b = 0; b < expected.size(); ++b)
            ASSERT_EQ(counts[static_cast<std::size_t>(b)], expected[b]) << size << " " << step;
        }
    EXPECT_EQ(sums.total(), naive(plane, colour_count, offsets, 0, 0, 80, step) -
                                naive(plane, colour_count, offsets, 0, 56, 80, step));
  }
}

// Sixteen bits hold the sums of a window, not those of a picture; the difference is right all the
// same, and a window too large for them is counted more thinly.
TEST(WindowSums, PictureOfOneColourDoesNotOverflow) {
  const Plane plane(640, 480, 0);
  const auto offsets = offsets_at({1, 3, 6, 10});
  const WindowSums sums(plane, 1, offsets, 10, 1, 10);
  std::vector<std::uint16_t> counts(static_cast<std::size_t>(sums.padded()));
  for (const auto& [x, y] : {std::pair(3, 0), std::pair(20, 10), std::pair(50, 36)}) {
    const std::uint32_t pairs = sums.window(x, y, 10, counts);
    EXPECT_EQ(counts[0], pairs);
    EXPECT_EQ(pairs, 50u * 50u * 16u);  // every second pixel
  }
}

TEST(Scan, ScoresAreThoseOfTheDefinition) {
  const model::Scene scene = *model::make_scene(catalogue(), 21, {});
  const Plane fine = trained().palette.quantise(renderer().render(scene, lab_camera()));
  Plane plane = fine;
  for (auto& value : plane.values) value = static_cast<std::uint8_t>(trained().coarse[value]);
  ScanOptions options;
  options.windows = {8};
  const auto offsets = offsets_at(trained().distances);
  const int palette = trained().coarse_colours;
  const Eigen::VectorXf total = naive(plane, palette, offsets, 0, 0, 640, options.step) -
                                Eigen::VectorXf::Zero(pair_count(palette));
  const Eigen::VectorXf weight = (0.01f / (0.01f + (total / total.sum()).array())).matrix();
  const Votes votes = scan(trained(), fine, options);
  int compared = 0;
  for (std::size_t c = 0; c < votes.best.size(); ++c) {
    const Match& match = votes.best[c];
    if (!(match.score > 0)) continue;
    const Eigen::VectorXf counts =
        naive(plane, palette, offsets, match.left, match.top, match.side, options.step);
    const Eigen::VectorXf root = (counts / counts.sum()).cwiseSqrt();
    float expected = 0;
    for (Eigen::Index k = 0; k < trained().classes[c].prototypes.cols(); ++k) {
      const Eigen::VectorXf q = trained().classes[c].prototypes.col(k);
      const Eigen::VectorXf weighted = weight.cwiseProduct(q);
      expected =
          std::max(expected, weighted.dot(root) / std::max(0.35f, std::sqrt(weighted.dot(q))));
    }
    EXPECT_NEAR(match.score, expected, 1e-3) << trained().classes[c].name;
    ++compared;
  }
  EXPECT_GE(compared, 2);  // of the three objects; one may win no window of this one size
}

TEST(Scan, CoarseToFineFindsWhatAllWindowsFind) {
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    const model::Scene scene = *model::make_scene(catalogue(), seed, {});
    const Plane fine = trained().palette.quantise(renderer().render(scene, lab_camera()));
    ScanOptions all;
    all.slack = 1;
    const Votes slow = scan(trained(), fine, all), quick = scan(trained(), fine);
    for (std::size_t c = 0; c < slow.best.size(); ++c)
      EXPECT_NEAR(slow.best[c].score, quick.best[c].score, 0.01)
          << trained().classes[c].name << ", seed " << seed;
  }
}

TEST(Scan, RegionOfTheStrongestCellIsTheObject) {
  // Away from cell borders too: the centre is finer than a cell.
  for (const double shift : {0.0, 0.004, 0.008}) {
    model::Scene scene = *model::make_scene(catalogue(), 3, {});
    scene.objects.clear();
    scene.objects.push_back({"Cup", make_pose({0.05 + shift, 0.02, 0.0465})});
    const Plane fine = trained().palette.quantise(renderer().render(scene, lab_camera()));
    const Region region = grow_strongest(scan(trained(), fine));
    ASSERT_GE(region.class_index, 0);
    EXPECT_EQ(trained().classes[static_cast<std::size_t>(region.class_index)].name, "Cup");
    const auto middle = lab_camera().project({0.05 + shift, 0.02, 0.0465});
    EXPECT_LT((region.centre - *middle).norm(), 10) << shift;  // one cell
  }
}

TEST(Scan, ErasedRegionsLeaveTheOthers) {
  const model::Scene scene = *model::make_scene(catalogue(), 5, {});
  const Plane fine = trained().palette.quantise(renderer().render(scene, lab_camera()));
  Votes votes = scan(trained(), fine);
  const Region first = grow_strongest(votes);
  ASSERT_GE(first.class_index, 0);
  erase(votes, first.left, first.top, first.right, first.bottom);
  const Region second = grow_strongest(votes);
  ASSERT_GE(second.class_index, 0);
  EXPECT_LE(second.strength, first.strength);
  const bool apart = second.right <= first.left || second.left >= first.right ||
                     second.bottom <= first.top || second.top >= first.bottom;
  EXPECT_TRUE(apart);
}

TEST(Scan, ScalesFindWhatIsSeenSmaller) {
  // Twice as far away as in training an object is half as large: so are its pairs' distances.
  CameraModel far = lab_camera();
  far.X_WC.translation() *= 2;
  model::Scene scene = *model::make_scene(catalogue(), 3, {});
  float once = 0, scaled = 0;
  for (const auto& object : catalogue().objects()) {
    scene.objects = {{object.name, standing_pose(object.shape, {0, 0, 0.3})}};
    const Plane fine = trained().palette.quantise(renderer().render(scene, far));
    std::size_t c = 0;
    while (trained().classes[c].name != object.name) ++c;
    ScanOptions options;
    once += scan(trained(), fine, options).best[c].score;
    options.scales = {1, 0.5};
    scaled += scan(trained(), fine, options).best[c].score;
  }
  EXPECT_GT(scaled, once + 0.02f * static_cast<float>(catalogue().objects().size()));
}

TEST(Scan, PictureSmallerThanACellHasNoVotes) {
  EXPECT_TRUE(scan(trained(), Plane(9, 9)).classes.front().size() == 0);
  EXPECT_LT(grow_strongest(scan(trained(), Plane(30, 30))).strength, 1e3f);
}

}  // namespace
}  // namespace prehend::recognition
