#include "services/glove/devices/paced.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "common/base/clock.hpp"

namespace prehend::glove {

PacedDevice::PacedDevice(std::unique_ptr<FrameSource> source, PacedOptions options)
    : source_(std::move(source)), options_(std::move(options)) {}

void PacedDevice::start(DeviceSink sink) {
  thread_ = std::jthread(
      [this, sink = std::move(sink)](const std::stop_token& stop) { run(stop, sink); });
}

void PacedDevice::run(const std::stop_token& stop, const DeviceSink& sink) const {
  using Clock = std::chrono::steady_clock;
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  const Clock::time_point start = Clock::now();
  const Time start_stamp = process_now();
  for (std::uint64_t n = 0;; ++n) {
    if (!options_.every_frame) {
      const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
      n = std::max(n, static_cast<std::uint64_t>(elapsed * options_.rate));
    }
    std::optional<Frame> frame = source_->frame(n);
    if (!frame) {
      sink.degraded(options_.at_end);
      return;
    }
    const Duration offset = frame->stamp.time_since_epoch();
    wake.wait_until(lock, stop, start + offset, [] { return false; });
    if (stop.stop_requested()) return;
    frame->stamp = options_.every_frame ? start_stamp + offset : process_now();
    sink.frame(std::move(*frame));
  }
}

}  // namespace prehend::glove
