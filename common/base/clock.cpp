#include "common/base/clock.hpp"

#include <time.h>

namespace prehend {
namespace {

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// Since the machine was started, also while it slept.
Duration running() {
  timespec time{};
  ::clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::seconds(time.tv_sec) + Duration(time.tv_nsec);
}

/// The system's clock when the machine was started. Of several readings the one that was
/// interrupted least: two processes of one machine must not differ.
Time read_start() {
  Duration least = Duration::max();
  Time start;
  for (int i = 0; i < 20; ++i) {
    const Duration before = running();
    const Time now = system_now();
    const Duration took = running() - before;
    if (took >= least) continue;
    least = took;
    start = now - before - took / 2;
  }
  return start;
}

Time start() {
  static const Time at_start = read_start();
  return at_start;
}

}  // namespace

Time process_now() {
  return start() + running();
}

Duration clock_step() {
  const Duration away = system_now() - process_now();
  return std::chrono::abs(away) < std::chrono::milliseconds(10) ? Duration::zero() : away;
}

}  // namespace prehend
