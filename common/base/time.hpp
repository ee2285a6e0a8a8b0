#pragma once

#include <chrono>
#include <cstdint>

namespace prehend {

/// Points in time are nanoseconds since 1970-01-01T00:00:00Z, as in the messages. Cores get them as
/// values and never ask a clock.
using Duration = std::chrono::nanoseconds;
using Time = std::chrono::sys_time<Duration>;

inline Time from_ns(std::int64_t ns) {
  return Time(Duration(ns));
}
inline std::int64_t to_ns(Time time) {
  return time.time_since_epoch().count();
}

/// Seconds as a duration, rounded to the nanosecond, and back.
inline Duration seconds(double s) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(s));
}
inline double to_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace prehend
