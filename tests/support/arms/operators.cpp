#include "tests/support/arms/operators.hpp"

#include <limits>

#include "tests/support/arms/arms.hpp"

namespace prehend::test {

Operator::Operator(const model::ArmModel& arm, std::uint64_t seed)
    : arm_(arm), random_(seed), X_WB_(arm::end_pose(arm, arm.home)), goal_(X_WB_) {
  choose_goal();
}

void Operator::choose_goal() {
  left_ = 20 + static_cast<int>(random_.index(80));
  speed_ = random_.uniform(0.05, 2.0);
  turning_ = random_.uniform(0.1, 6.0);
  tremor_ = random_.uniform() < 0.3 ? random_.uniform(0, 0.02) : 0;
  goal_ = arm::end_pose(arm_, random_posture(arm_, random_));
  const double kind = random_.uniform();
  if (kind < 0.15) goal_.translation() *= 3;               // out of reach
  if (kind > 0.85) goal_.translation().z() = -0.2;         // through the table
  if (kind > 0.4 && kind < 0.5) goal_.translation() *= 0;  // into the base
  if (random_.uniform() < 0.1) X_WB_ = goal_;              // a jump, as of a lost tracker
}

std::pair<arm::Wish, double> Operator::next() {
  if (--left_ < 0) choose_goal();
  const double dt = random_.uniform() < 0.05 ? random_.uniform(0.001, 0.1) : 0.01;
  const Pose before = X_WB_;
  X_WB_ = limit_step(X_WB_, goal_, speed_ * dt, turning_ * dt);
  arm::Wish wish{X_WB_, arm::Vector6::Zero()};
  if (random_.uniform() < 0.5) wish.velocity_W = arm::way_between(before, X_WB_) / dt;
  wish.X_WB.translation() += random_.normal3(tremor_);
  if (random_.uniform() < 0.005)
    wish.X_WB.translation().y() = std::numeric_limits<double>::quiet_NaN();
  return {wish, dt};
}

}  // namespace prehend::test
