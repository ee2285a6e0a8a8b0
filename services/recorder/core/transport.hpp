#pragma once

#include "common/base/time.hpp"

namespace prehend::recorder {

/// Where a tape stands while the clock on the wall goes on: a straight line that is bent by pause,
/// rate and seek. Pure; the clock's time comes as a value and must not go back.
class Transport {
 public:
  /// Paused at `position`.
  explicit Transport(Time position) : position_(position) {}

  Time position(Time now) const;
  /// When the tape will be at `position`, in its present course. Only while it runs.
  Time when(Time position) const;

  void run(Time now);
  void pause(Time now);
  void set_rate(Time now, double rate);  // more than 0
  void seek(Time now, Time position);

  bool runs() const { return runs_; }
  double rate() const { return rate_; }

 private:
  void mark(Time now);

  Time position_, marked_{};  // it was there then
  double rate_ = 1;
  bool runs_ = false;
};

}  // namespace prehend::recorder
