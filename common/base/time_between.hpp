#pragma once

#include <limits>

#include "common/base/time.hpp"

namespace prehend {

/// later - earlier, of stamps that anybody may have made up: what is too far apart for a duration
/// is the longest one, and never overflows.
inline Duration between(Time earlier, Time later) {
  std::int64_t ns = 0;
  if (!__builtin_sub_overflow(to_ns(later), to_ns(earlier), &ns)) return Duration(ns);
  return later > earlier ? Duration::max() : Duration::min();
}

/// stamp - by; the last or the first time that there is instead of one that does not fit.
inline Time moved(Time stamp, Duration by) {
  return Time(between(Time(by), stamp));
}

/// Is it no further away than that, in either direction?
inline bool is_within(Time stamp, Time now, Duration most) {
  const Duration age = between(stamp, now);
  return age <= most && age >= -most;
}

}  // namespace prehend
