// What all episodes have, statistics of columns and their range as -1 to 1.
#include "services/recorder/core/dataset/features.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace prehend::recorder::dataset {
namespace {

using ::testing::ElementsAre;

Feature feature(const std::string& name, int columns) {
  return {name, About::object, std::vector<std::string>(static_cast<std::size_t>(columns), "c"),
          Table::Zero(2, columns)};
}

TEST(Features, OnlyWhatAllHaveStays) {
  Rows a, b;
  a.others = {feature("object", 7), feature("tips", 15), feature("only_a", 1)};
  b.others = {feature("tips", 9), feature("object", 7)};
  a.pictures = {{"front", {0}}, {"side", {0}}};
  b.pictures = {{"front", {0}}};
  EXPECT_THAT(keep_common({&a, &b}), ElementsAre("only_a", "side", "tips"));
  ASSERT_EQ(a.others.size(), 1u);
  ASSERT_EQ(b.others.size(), 1u);
  EXPECT_EQ(a.others[0].name, "object");
  EXPECT_EQ(b.others[0].name, "object");
  EXPECT_EQ(a.pictures.size(), 1u);
}

TEST(Features, StatisticsOfPartsAreThoseOfTheWhole) {
  std::srand(1);
  const Table all = Table::Random(100, 3) * 5;
  const Statistics whole = statistics(all);
  const Statistics parts =
      together({statistics(all.topRows(10)), statistics(all.middleRows(10, 60)),
                statistics(all.bottomRows(30))});
  EXPECT_EQ(parts.count, 100u);
  EXPECT_TRUE(parts.min.isApprox(whole.min));
  EXPECT_TRUE(parts.max.isApprox(whole.max));
  EXPECT_TRUE(parts.mean.isApprox(whole.mean, 1e-12));
  EXPECT_TRUE(parts.deviation.isApprox(whole.deviation, 1e-12));
}

TEST(Features, StatisticsByHand) {
  Table values(4, 1);
  values << 1, 2, 3, 6;
  const Statistics one = statistics(values);
  EXPECT_EQ(one.mean[0], 3);
  EXPECT_NEAR(one.deviation[0], std::sqrt(14.0 / 4), 1e-12);
}

TEST(Features, AreScaledToTheirRange) {
  Table values(3, 2);
  values << -2, 5, 0, 5, 6, 5;
  const Table all = scaled(values, statistics(values));
  EXPECT_TRUE(all.col(0).isApprox(Eigen::Vector3d(-1, -0.5, 1), 1e-12));
  EXPECT_EQ(all.col(1), Eigen::Vector3d::Zero());  // what never changes says nothing
}

}  // namespace
}  // namespace prehend::recorder::dataset
