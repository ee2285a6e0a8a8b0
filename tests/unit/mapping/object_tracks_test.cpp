// What is known of objects: the newest detection of each, and mean and variance of its size with
// weights that fall by 0.8 from each detection to the one before. The recursion must give what the
// sums over all detections give; 1e-12: rounding of a few dozen additions of centimetres.
#include "services/mapping/core/object_tracks.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

Time seen_at(int ms) {
  return Time(std::chrono::seconds(1'700'000'000) + milliseconds(ms));
}

Detection cylinder(double radius, int ms, std::uint32_t track = 1) {
  return {track,
          "object",
          {model::ShapeKind::cylinder, {radius, radius, 0.1}},
          make_pose({0, 0, 0.05}),
          0.9,
          seen_at(ms)};
}

TEST(ObjectTracks, SizesHaveTheMeanAndVarianceOfFallingWeights) {
  Random random(1);
  for (int run = 0; run < 50; ++run) {
    ObjectTracks tracks({});
    std::vector<double> sizes;
    for (int i = 0; i < 40; ++i) {
      sizes.push_back(random.uniform(0.01, 0.05));
      ASSERT_TRUE(tracks.observe(cylinder(sizes.back(), 33 * i)));
      double mean = 0, variance = 0, weight = 1;
      std::vector<double> weights(sizes.size());
      for (std::size_t k = sizes.size(); k-- > 1; weight *= 0.8) weights[k] = 0.2 * weight;
      weights[0] = weight;  // nothing came before the first
      for (std::size_t k = 0; k < sizes.size(); ++k) mean += weights[k] * sizes[k];
      for (std::size_t k = 0; k < sizes.size(); ++k)
        variance += weights[k] * (sizes[k] - mean) * (sizes[k] - mean);
      const ObjectTrack& known = tracks.known().at(1);
      ASSERT_NEAR(known.size, mean, 1e-12);
      ASSERT_NEAR(known.size_variance, variance, 1e-12);
    }
  }
}

TEST(ObjectTracks, KeepTheNewestDetectionOfEachObject) {
  ObjectTracks tracks({});
  ASSERT_TRUE(tracks.observe(cylinder(0.02, 100, 1)));
  ASSERT_TRUE(tracks.observe(cylinder(0.03, 50, 2)));
  ASSERT_TRUE(tracks.observe(cylinder(0.03, 100, 1)));  // as new as the one before
  const auto late = tracks.observe(cylinder(0.04, 99, 1));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().what, "detection out of order");
  EXPECT_EQ(tracks.known().at(1).detection.shape.size.x(), 0.03);
  EXPECT_EQ(tracks.known().at(2).detection.stamp, seen_at(50));
  tracks.remove(1);
  tracks.remove(7);  // nothing is known of it
  EXPECT_EQ(tracks.known().size(), 1u);
  // What has gone may come again from the past: it is another object.
  EXPECT_TRUE(tracks.observe(cylinder(0.04, 99, 1)));
}

TEST(ObjectTracks, ForgetWhatIsTooOldOrFromTheFuture) {
  ObjectTracks tracks({.max_age = milliseconds(500)});
  for (int i = 0; i <= 20; ++i)
    ASSERT_TRUE(tracks.observe(cylinder(0.02, 100 * i, static_cast<std::uint32_t>(i))));
  tracks.forget_old(seen_at(1000));
  EXPECT_EQ(tracks.known().size(), 11u);  // 0.5 s to 1.5 s, both ends
  EXPECT_TRUE(tracks.known().contains(5) && tracks.known().contains(15));
}

TEST(ObjectTracks, RefuseWhatCannotBeUsedAndKeepWhatIsKnown) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  ObjectTracks tracks({.min_probability = 0.6});
  const Detection good = cylinder(0.02, 0);
  ASSERT_TRUE(tracks.observe(good));
  const auto refused = [&](auto&& spoil) {
    Detection bad = good;
    bad.stamp = seen_at(10);
    spoil(bad);
    const bool taken = tracks.observe(bad).has_value();
    return !taken && tracks.known().at(1).detection.stamp == good.stamp;
  };
  EXPECT_TRUE(refused([](Detection& d) { d.shape.kind = model::ShapeKind::unknown; }));
  EXPECT_TRUE(refused([](Detection& d) { d.shape.size.x() = -0.02; }));
  EXPECT_TRUE(refused([](Detection& d) { d.X_WO.translation().y() = nan; }));
  EXPECT_TRUE(refused([](Detection& d) { d.probability = 0.59; }));
  EXPECT_TRUE(refused([](Detection& d) { d.probability = nan; }));
  EXPECT_TRUE(refused([](Detection& d) { d.covariance(0, 1) = nan; }));
  EXPECT_TRUE(refused([](Detection& d) { d.covariance(2, 2) = -1e-6; }));
  EXPECT_FALSE(refused([](Detection& d) { d.probability = 0.6; })) << "the bound itself";
}

}  // namespace
}  // namespace prehend::mapping
