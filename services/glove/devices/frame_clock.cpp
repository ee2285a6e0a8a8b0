#include "services/glove/devices/frame_clock.hpp"

#include <algorithm>

namespace prehend::glove {
namespace {

constexpr int acquisition = 32;      // arrivals that give the first estimate of the period
constexpr int block = 8;             // frames between two corrections
constexpr int max_jumps = 4;         // one after the other
constexpr double phase_gain = 0.5;   // of the phase that the least late frame of a block shows
constexpr double period_gain = 0.1;  // of the phase correction that each frame needed

}  // namespace

void FrameClock::restart() {
  frames_ = 0;
  period_ = 0;
  in_block_ = 0;
  corrected_ = 0;
  jumps_ = 0;
}

Time FrameClock::stamp(Time arrival) {
  const Time next = last_ + Duration(1);
  const double late = to_seconds(arrival - last_) - period_;
  if (late > slack) restart();
  return last_ = std::max(next, period_ > 0 ? follow(arrival, late) : acquire(arrival));
}

Time FrameClock::acquire(Time arrival) {
  if (frames_ == 0) first_ = arrival;
  if (++frames_ == acquisition) period_ = to_seconds(arrival - first_) / (acquisition - 1);
  return arrival;
}

Time FrameClock::follow(Time arrival, double late) {
  Time stamp = last_ + seconds(period_);
  if (late < 0) {  // earlier than the clock had thought possible
    stamp = arrival;
    corrected_ += late;
  }
  min_lateness_ = in_block_ == 0 ? late : std::min(min_lateness_, late);
  if (++in_block_ < block) return stamp;

  // Where even the least late frame was late, the clock lags behind the device: by whole periods
  // if frames were lost, and these say nothing about its rate.
  // Where they seem to be lost again and again, the rate is another.
  if (min_lateness_ > period_ / 2) {
    stamp += seconds(min_lateness_);
    if (++jumps_ == max_jumps) restart();
  } else {
    jumps_ = 0;
    const double ahead = phase_gain * std::max(min_lateness_, 0.0);
    stamp += seconds(ahead);
    period_ += period_gain * (corrected_ + ahead) / block;
  }
  in_block_ = 0;
  corrected_ = 0;
  return stamp;
}

}  // namespace prehend::glove
