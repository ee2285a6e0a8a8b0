// Whether a finding of the thesis is reproduced goes by intervals alone: all of one is on the one
// side, all on the other, or neither.
#include "services/mapping/tools/study/finding.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "common/statistics/intervals.hpp"

namespace prehend::mapping {
namespace {

TEST(Reproduction, GoesByTheInterval) {
  EXPECT_EQ(above_zero({1, 0.5, 1.5, 10}), Reproduction::reproduced);
  EXPECT_EQ(above_zero({-1, -1.5, -0.5, 10}), Reproduction::not_reproduced);
  EXPECT_EQ(above_zero({0.1, -0.5, 0.7, 10}), Reproduction::undecided);
  // Too little to matter, as far as can be told.
  EXPECT_EQ(above_zero({0, -0.01, 0.01, 10}, 0.05), Reproduction::not_reproduced);
  EXPECT_EQ(above_one({1.2, 1.1, 1.3, 10}), Reproduction::reproduced);
  EXPECT_EQ(above_one({1.01, 0.99, 1.03, 10}), Reproduction::not_reproduced);
  EXPECT_EQ(above_one({1.1, 0.9, 1.3, 10}), Reproduction::undecided);
}

TEST(Reproduction, IsUndecidedFromOneSample) {
  EXPECT_EQ(above_zero(statistics::mean_interval(std::vector{5.0})), Reproduction::undecided);
}

TEST(Reproduction, OfPartsNeedsAll) {
  using enum Reproduction;
  EXPECT_EQ(all_of(std::vector{reproduced, reproduced}), reproduced);
  EXPECT_EQ(all_of(std::vector{reproduced, undecided}), undecided);
  EXPECT_EQ(all_of(std::vector{undecided, not_reproduced}), not_reproduced);
  EXPECT_EQ(all_of(std::vector<Reproduction>{}), undecided);
}

}  // namespace
}  // namespace prehend::mapping
