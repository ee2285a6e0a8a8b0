#pragma once

#include "common/base/time.hpp"

namespace prehend::glove {

/// Stamps for the frames of a device that measures at a steady rate of its own and whose frames
/// arrive late by what lines, adapters and schedulers add: a phase-locked loop. It follows the
/// earliest arrivals, as a delay is never negative, and learns the device's period from them.
///
/// Stamps increase strictly. They are not later than the arrival, but for the nanoseconds that this
/// may take, and at most `slack` earlier.
class FrameClock {
 public:
  /// Of a frame that came at `arrival`, not earlier than the one before.
  Time stamp(Time arrival);
  /// What is known of rate and phase holds no more: the device was set up anew.
  void restart();
  /// s; 0 until it is known.
  double period() const { return period_; }

  /// A frame that is later than this comes after a pause, not after a delay.
  static constexpr double slack = 0.15;  // s

 private:
  Time acquire(Time arrival);
  Time follow(Time arrival, double late);

  int frames_ = 0;  // since the start, until the period is known
  Time first_{}, last_{};
  double period_ = 0;        // s; 0: not known
  int in_block_ = 0;         // frames since the last correction
  double min_lateness_ = 0;  // s, of these
  double corrected_ = 0;     // s, of phase while they came
  int jumps_ = 0;            // blocks, the last ones, in which frames were lost
};

}  // namespace prehend::glove
