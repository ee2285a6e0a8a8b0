#include "services/demonstration/tools/evaluation/judged.hpp"

#include <gtest/gtest.h>

namespace prehend::demonstration {
namespace {

Judged grasp(std::string user, std::size_t truth, const Eigen::Vector3d& answer) {
  return {std::move(user), truth, answer, {}};
}

const std::vector<Judged> four{grasp("a", 0, {0.9, 0.1, 0}), grasp("a", 1, {0.6, 0.4, 0}),
                               grasp("b", 1, {0, 1, 0}), grasp("b", 2, {0, 0.3, 0.7})};

TEST(Judged, CountsWhatIsRightAndHowSure) {
  EXPECT_DOUBLE_EQ(accuracy(four), 0.75);
  // (0.02 + 0.72 + 0 + 0.18) / 4
  EXPECT_NEAR(brier(four), 0.23, 1e-12);
  EXPECT_DOUBLE_EQ(accuracy_at(four, 0.75), 1);  // the wrong one is the least sure
  EXPECT_DOUBLE_EQ(accuracy_at(four, 1), 0.75);
  EXPECT_NEAR(deviation_between_people(four), std::sqrt(0.125), 1e-12);
  const auto counts = confusion(four, 3);
  EXPECT_EQ(counts[1][0], 1);
  EXPECT_EQ(counts[1][1], 1);
  EXPECT_EQ(counts[0][0] + counts[2][2], 2);
}

TEST(Judged, FamiliesForgiveWhatIsAlike) {
  EXPECT_DOUBLE_EQ(family_accuracy(four, {0, 0, 1}), 1);
  EXPECT_DOUBLE_EQ(family_accuracy(four, {0, 1, 1}), 0.75);
}

TEST(Judged, ReliabilityPutsWhatWasSaidBesideWhatHeld) {
  const auto bins = reliability(four);
  EXPECT_EQ(bins[9].count, 2U);  // 0.9 and 1
  EXPECT_NEAR(bins[9].said, 0.95, 1e-12);
  EXPECT_EQ(bins[6].held, 0);
  EXPECT_EQ(bins[7].held, 1);
}

TEST(Judged, AStreamIsRightFromSomeShareOn) {
  auto streamed = four;
  for (Judged& one : streamed) one.stream = {9, 9, one.truth, one.truth};
  EXPECT_DOUBLE_EQ(accuracy_after(streamed, 0.5), 0);
  EXPECT_DOUBLE_EQ(accuracy_after(streamed, 0.75), 1);
  EXPECT_DOUBLE_EQ(accuracy_after(streamed, 0.01), 0);
  EXPECT_EQ(accuracy({}), 0);
  EXPECT_EQ(brier({}), 0);
}

}  // namespace
}  // namespace prehend::demonstration
