// The figures of an evaluation against values worked out by hand.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/base/random.hpp"
#include "services/recognition/tools/evaluation/report.hpp"

namespace prehend::recognition {
namespace {

std::vector<Judged> some() {
  return {{"a", 0, 0, 0.9},  {"b", 0, 1, 0.4},  {"c", 1, 1, 0.95},
          {"d", 1, 1, 0.55}, {"e", -1, 0, 0.3}, {"f", -1, -1, 0.0}};
}

TEST(Judged, ThresholdLetsThroughWhatItSays) {
  const auto pictures = some();
  EXPECT_EQ(threshold_for(pictures, 0.75), 0.55);
  const Accepted accepted = accept(pictures, 0.35);
  EXPECT_EQ(accepted.known, 4u);
  EXPECT_EQ(accepted.known_accepted, 4u);
  EXPECT_EQ(accepted.wrong_accepted, 1u);
  EXPECT_EQ(accepted.strangers, 2u);
  EXPECT_EQ(accepted.strangers_rejected, 2u);
  EXPECT_EQ(accept(pictures, 0.2).strangers_rejected, 1u);
  EXPECT_EQ(threshold_for({}, 0.9), 0);
}

TEST(Judged, ConfusionCountsTruthByAnswer) {
  const auto counts = confusion(some(), 2);
  EXPECT_EQ(counts, (std::vector<std::vector<int>>{{1, 1}, {0, 2}}));
}

TEST(Judged, ReliabilityOfHonestAnswersLiesOnTheDiagonal) {
  Random random(1);
  std::vector<Judged> pictures;
  for (int i = 0; i < 20000; ++i) {
    const double p = random.uniform(0, 1);
    pictures.push_back({"", 0, random.uniform(0, 1) < p ? 0 : 1, p});
  }
  for (const Bin& bin : reliability(pictures)) EXPECT_NEAR(bin.said, bin.held, 0.05);  // 4 sigma
  EXPECT_NEAR(brier(pictures), 1.0 / 6, 0.01);  // the mean of p (1 - p)
  EXPECT_EQ(brier({}), 0);
}

TEST(Report, ShowsFailuresAndEscapesNames) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("objects-report" + std::to_string(getpid()));
  const auto written = write_report(folder, "a <b> & c", {"one", "<two>"}, some(), 0.5);
  ASSERT_TRUE(written) << written.error().message();
  std::ifstream in(folder / "index.html");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(folder / "index.html");
  std::filesystem::create_directory(folder / "index.html");
  const auto blocked = write_report(folder, "a", {"one", "two"}, some(), 0.5);
  std::filesystem::remove_all(folder);
  ASSERT_FALSE(blocked);
  EXPECT_EQ(blocked.error().message(),
            (folder / "index.html").string() + ": cannot be written (is the place writable?)");
  EXPECT_NE(page.find("a &lt;b&gt; &amp; c"), std::string::npos);
  EXPECT_EQ(page.find("<two>"), std::string::npos);
  std::size_t figures = 0;
  for (std::size_t at = 0; (at = page.find("<figure>", at)) != std::string::npos; ++at) ++figures;
  EXPECT_EQ(figures, 1u);  // «b»: taken for another; no stranger came through
}

}  // namespace
}  // namespace prehend::recognition
