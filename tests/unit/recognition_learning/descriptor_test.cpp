// The descriptor against its definitions. Quantising by table must equal the nearest centre of the
// table's cell, searched naively, exactly; counts are whole numbers and must be equal exactly
// (tests/unit/recognition/cooccurrence_test.cpp has sliding windows and masks). Similarities are
// sums of at most 2080 products of floats: 1e-5. L*a*b* is compared with CIE's own figures, which
// are given to two decimals.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/recognition_learning/painted.hpp"

namespace prehend::recognition {
namespace {

Picture random_picture(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Picture made(width, height);
  for (auto& value : made.rgb) value = static_cast<std::uint8_t>(random.index(256));
  return made;
}

/// Chang and Krumm's definition, pixel by pixel: nearest colours first, then all pairs of pixels at
/// the offsets with both in the mask.
Eigen::VectorXd naive(const Picture& picture, const Plane& mask, const Palette& palette,
                      const std::vector<int>& distances) {
  const auto colour = [&](int x, int y) {
    const std::uint8_t* p = picture.at(x, y);
    const auto middle = [](std::uint8_t v) { return static_cast<std::uint8_t>((v & 0xf8) + 4); };
    const Eigen::Vector3f f =
        colour_feature(palette.space(), middle(p[0]), middle(p[1]), middle(p[2]));
    int best = 0;
    for (int k = 1; k < palette.size(); ++k)
      if ((f - palette.centres()[static_cast<std::size_t>(k)]).squaredNorm() <
          (f - palette.centres()[static_cast<std::size_t>(best)]).squaredNorm())
        best = k;
    return best;
  };
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(pair_count(palette.size()));
  for (const Offset& o : offsets_at(distances))
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const int u = x + o.dx, v = y + o.dy;
        if (u < 0 || v < 0 || u >= picture.width || v >= picture.height) continue;
        if (mask.at(x, y) && mask.at(u, v)) counts[pair_index(colour(x, y), colour(u, v))] += 1;
      }
  return counts;
}

TEST(Descriptor, FastEqualsNaiveForEverySpaceAndMask) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    ColourSpace space;
    space.colours = seed % 2 == 0 ? Colours::lab : Colours::chromaticity;
    space.brightness_weight = random.uniform(0, 1);
    const Picture picture = random_picture(37, 29, seed);
    std::vector<Eigen::Vector3f> features;
    for (std::size_t p = 0; p < picture.pixels(); ++p)
      features.push_back(colour_feature(space, picture.rgb[3 * p], picture.rgb[3 * p + 1],
                                        picture.rgb[3 * p + 2]));
    const Palette palette = Palette::learn(space, features, 9, seed);
    Plane mask(37, 29);
    for (auto& m : mask.values) m = random.index(3) > 0;
    const std::vector<int> distances = {0, 1, 4, 7};
    const Eigen::VectorXd fast =
        cooccurrence(palette.quantise(picture), palette.size(), offsets_at(distances), mask)
            .cast<double>();
    EXPECT_LE((fast - naive(picture, mask, palette, distances)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Descriptor, DistanceZeroIsThePlainHistogram) {
  const TrainingView view = painted_classes(1, 1)[0].views[0];
  const ObjectModels models = *train(painted_classes(1, 1), {.colours = 8, .distances = {0}});
  const Plane colours = models.palette.quantise(view.picture);
  const Eigen::VectorXf pairs =
      cooccurrence(colours, models.palette.size(), offsets_at({0}), view.mask);
  for (int a = 0; a < models.palette.size(); ++a)
    for (int b = 0; b <= a; ++b) {
      float expected = 0;
      for (std::size_t p = 0; a == b && p < colours.values.size(); ++p)
        expected += view.mask.values[p] && colours.values[p] == a;
      EXPECT_EQ(pairs[pair_index(a, b)], expected);
    }
}

TEST(Descriptor, EveryWeightingIsOneForEqualOnesAndSymmetric) {
  Random random(3);
  Eigen::MatrixXf counts(21, 4);
  for (Eigen::Index i = 0; i < counts.size(); ++i)
    counts.data()[i] = static_cast<float>(random.index(50));
  const Eigen::VectorXf idf = Eigen::VectorXf::LinSpaced(21, 0.2f, 1.5f);
  for (const Weighting w :
       {Weighting::idf_hellinger, Weighting::hellinger, Weighting::intersection}) {
    Eigen::MatrixXf d(21, 4);
    for (Eigen::Index i = 0; i < 4; ++i) d.col(i) = descriptor(counts.col(i), idf, w);
    const Eigen::MatrixXf s = similarities(d, d, w);
    EXPECT_LT((s - s.transpose()).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_LT((s.diagonal().array() - 1).abs().maxCoeff(), 1e-5);
    EXPECT_LE(s.maxCoeff(), 1 + 1e-5);
    EXPECT_GE(s.minCoeff(), 0);
    if (w != Weighting::intersection) continue;
    double expected = 0;  // Swain and Ballard's sum of the smaller shares
    for (Eigen::Index b = 0; b < 21; ++b)
      expected += std::min(counts(b, 0) / counts.col(0).sum(), counts(b, 1) / counts.col(1).sum());
    EXPECT_NEAR(s(0, 1), expected, 1e-5);
  }
}

TEST(ColourSpace, LabHasTheValuesOfCie) {
  const ColourSpace space{.brightness_weight = 1, .colours = Colours::lab};
  const auto lab = [&](std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    return Eigen::Vector3f(100 * colour_feature(space, r, g, b));  // a, b, L
  };
  EXPECT_LT((lab(255, 255, 255) - Eigen::Vector3f(0, 0, 100)).norm(), 0.05);
  EXPECT_LT((lab(0, 0, 0) - Eigen::Vector3f(0, 0, 0)).norm(), 0.05);
  EXPECT_LT((lab(255, 0, 0) - Eigen::Vector3f(80.09f, 67.20f, 53.24f)).norm(), 0.05);
  EXPECT_LT((lab(0, 0, 255) - Eigen::Vector3f(79.19f, -107.86f, 32.30f)).norm(), 0.05);
}

// Light of another colour scales the channels; that is exactly what constancy takes out, up to
// rounding (a level or two) as long as nothing is clipped.
TEST(Constancy, TakesOutTheColourOfTheLight) {
  Picture picture = random_picture(40, 30, 2), reddish = picture;
  for (auto& v : picture.rgb) v = static_cast<std::uint8_t>(40 + v / 4);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    reddish.rgb[i] = static_cast<std::uint8_t>(picture.rgb[i] * (i % 3 == 0   ? 1.3
                                                                 : i % 3 == 1 ? 1.0
                                                                              : 0.8));
  for (const Constancy constancy : {Constancy::grey_world, Constancy::shades_of_grey}) {
    const Picture a = balanced(picture, constancy), b = balanced(reddish, constancy);
    // Both are grey now; how bright, the mean of the channels says, which the light changed too.
    double gain = 0, most = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) gain += static_cast<double>(b.rgb[i]) / a.rgb[i];
    gain /= static_cast<double>(a.rgb.size());
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
      most = std::max(most, std::abs(b.rgb[i] - gain * a.rgb[i]));
    EXPECT_LT(most, 3.5);
  }
  EXPECT_EQ(balanced(picture, Constancy::none).rgb, picture.rgb);
  EXPECT_TRUE(balanced(Picture(), Constancy::grey_world).empty());
}

}  // namespace
}  // namespace prehend::recognition
