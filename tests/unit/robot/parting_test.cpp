// Where two hands that are told the same part.
#include "services/robot/core/parting.hpp"

#include <gtest/gtest.h>

namespace prehend::robot {
namespace {

using std::chrono::milliseconds;

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("barrett"));
  return *loaded;
}

Eigen::VectorXd fingers(double first) {
  Eigen::VectorXd dof = Eigen::VectorXd::Zero(4);
  dof[1] = first;
  return dof;
}

Time at(int ms) {
  return from_ns(0) + milliseconds(ms);
}

TEST(Parting, WhatLatenciesExplainIsNone) {
  Parting parting(hand(), {.within = 0.1, .patience = milliseconds(300)});
  // Far apart for a moment, and a little for ever.
  for (int ms = 0; ms < 250; ms += 10)
    EXPECT_TRUE(parting.compare(fingers(1), fingers(0.2), at(ms)).empty());
  for (int ms = 250; ms < 2000; ms += 10)
    EXPECT_TRUE(parting.compare(fingers(1), fingers(0.95), at(ms)).empty());
  EXPECT_FALSE(parting.parted());
  EXPECT_NEAR(parting.dofs()[1].worst, 0.8, 1e-12);
  EXPECT_EQ(parting.compared(), 200);
}

TEST(Parting, ADofThatStaysApartIsToldOnceAndWhen) {
  Parting parting(hand(), {.within = 0.1, .patience = milliseconds(300)});
  std::vector<int> told;
  for (int ms = 0; ms < 2000; ms += 10)
    for (const std::size_t d : parting.compare(fingers(ms < 500 ? 0.2 : 1), fingers(0.2), at(ms))) {
      EXPECT_EQ(d, 1u);
      told.push_back(ms);
    }
  EXPECT_EQ(told, std::vector<int>{800});
  EXPECT_EQ(*parting.dofs()[1].parted, at(500));
  EXPECT_TRUE(parting.dofs()[1].apart);
  EXPECT_FALSE(parting.dofs()[2].parted);
  // Together again, and apart once more: the first time counts.
  parting.compare(fingers(0.2), fingers(0.2), at(2000));
  EXPECT_FALSE(parting.dofs()[1].apart);
  parting.compare(fingers(1), fingers(0.2), at(2010));
  EXPECT_EQ(parting.compare(fingers(1), fingers(0.2), at(2400)).size(), 1u);
  EXPECT_EQ(*parting.dofs()[1].parted, at(500));
  EXPECT_TRUE(parting.parted());
}

}  // namespace
}  // namespace prehend::robot
