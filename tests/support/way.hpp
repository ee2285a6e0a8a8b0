#pragma once

#include <gtest/gtest.h>

#include <algorithm>

namespace prehend::test {

/// The length of a way against a speed: of what a gate passes in any time T it is at most
/// speed · (T + 300 ms). With the length S and t = time that is
/// S(j) − S(i) − speed · (t(j) − t(i)) ≤ 0.3 s · speed for all i < j, so the least
/// S(i) − speed · t(i) so far suffices.
class Way {
 public:
  explicit Way(double speed) : speed_(speed) {}
  void go(double length, double t) {
    if (begun_)
      lowest_ = std::min(lowest_, length_ - speed_ * t_);
    else
      lowest_ = -speed_ * t;
    begun_ = true;
    length_ += length;
    t_ = t;
    EXPECT_LE(length_ - speed_ * t - lowest_, 0.3 * speed_ * (1 + 1e-6) + 1e-6);
  }

 private:
  double speed_, length_ = 0, t_ = 0, lowest_ = 0;
  bool begun_ = false;
};

}  // namespace prehend::test
