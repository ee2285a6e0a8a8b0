// The gate lets motion through and withholds extreme points; a true jump costs one frame.
#include "services/glove/core/gate.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;
using Verdict = PointGate::Verdict;

Time at(double s) {
  return Time(seconds(s));
}

TEST(PointGate, NeedsTwoReadingsToBegin) {
  PointGate gate(GateOptions{});
  EXPECT_EQ(gate.check(at(0), {0, 0, 0}), Verdict::unconfirmed);
  EXPECT_EQ(gate.check(at(1 / 30.), {0.001, 0, 0}), Verdict::good);
}

TEST(PointGate, WithholdsASinglePointAndGoesOn) {
  PointGate gate(GateOptions{});
  gate.check(at(0), {0, 0, 0});
  gate.check(at(1 / 30.), {0, 0, 0});
  EXPECT_EQ(gate.check(at(2 / 30.), {0.2, 0, 0}), Verdict::extreme);
  EXPECT_EQ(gate.check(at(3 / 30.), {0, 0, 0}), Verdict::good);
}

TEST(PointGate, BelievesAJumpThatLasts) {
  PointGate gate(GateOptions{});
  gate.check(at(0), {0, 0, 0});
  gate.check(at(1 / 30.), {0, 0, 0});
  EXPECT_EQ(gate.check(at(2 / 30.), {0.4, 0, 0}), Verdict::extreme);
  EXPECT_EQ(gate.check(at(3 / 30.), {0.4, 0, 0}), Verdict::good);
}

TEST(PointGate, TwoExtremePointsInARowDoNotConfirmEachOther) {
  PointGate gate(GateOptions{});
  gate.check(at(0), {0, 0, 0});
  gate.check(at(1 / 30.), {0, 0, 0});
  EXPECT_EQ(gate.check(at(2 / 30.), {0.3, 0, 0}), Verdict::extreme);
  EXPECT_EQ(gate.check(at(3 / 30.), {-0.3, 0.1, 0}), Verdict::extreme);
  EXPECT_EQ(gate.check(at(4 / 30.), {0, 0, 0}), Verdict::good);
}

TEST(PointGate, ForgetsAfterAPause) {
  PointGate gate(GateOptions{});
  gate.check(at(0), {0, 0, 0});
  gate.check(at(0.03), {0, 0, 0});
  EXPECT_EQ(gate.check(at(1), {0, 0, 0}), Verdict::unconfirmed);
}

// A brisk sine, 0.25 m at 1 Hz (peak 1.6 m/s, 10 m/s²), with the tracker's noise: nothing of it is
// extreme, at any rate.
TEST(PointGate, LetsQuickMotionThroughAtAnyRate) {
  for (const double rate : {15., 30., 100., 1000.}) {
    PointGate gate(GateOptions{});
    Random random(3);
    int withheld = 0;
    for (int n = 0; n < 5 * rate; ++n) {
      const double t = n / rate;
      const Vector3d p = Vector3d(0.25 * std::sin(6.283 * t), 0, 0) + random.normal3(0.0015);
      withheld += gate.check(at(t), p) != Verdict::good;
    }
    EXPECT_LE(withheld, 1) << rate << " Hz: the first reading alone waits to be confirmed";
  }
}

}  // namespace
}  // namespace prehend::glove
