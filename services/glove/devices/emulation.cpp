#include "services/glove/devices/emulation.hpp"

#include <algorithm>
#include <thread>

#include "common/serial/wire.hpp"

namespace prehend::glove {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

Expected<void> emulate(const EmulationOptions& options, const FrameSource& source,
                       const std::function<bool()>& stopped) {
  constexpr Duration glance = std::chrono::milliseconds(20);  // at `stopped`
  const Clock::time_point start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration_cast<Duration>(Clock::now() - start); };
  Faults faults(options.faults);
  std::unique_ptr<serial::Plug> plug;
  std::unique_ptr<Emulator> device;
  serial::Wire wire(options.baud);
  std::uint64_t tick = 0, n = 0;
  // Nobody reaches before somebody looks. On a line the host speaks first, datagrams just come.
  std::optional<Duration> begun;
  if (options.baud == 0) begun = Duration::zero();
  std::optional<Frame> current = source.frame(0), next = source.frame(1);
  if (!current) return fail("the source has no frame", "emulator", "choose another");

  while (!stopped()) {
    if (faults.unplugged(elapsed())) {
      plug.reset();
      std::this_thread::sleep_for(glance);
      continue;
    }
    if (!plug) {
      auto made = options.plug_in();
      if (!made) return tl::unexpected(made.error());
      plug = std::move(*made);
      device = options.device();
      wire = serial::Wire(options.baud);
      if (options.on_plugged) options.on_plugged(plug->where());
    }
    const Duration due = seconds(static_cast<double>(tick) / options.rate);
    const std::string heard =
        plug->read(std::clamp(wire.next(due) - elapsed(), Duration::zero(), glance));
    const Duration now = elapsed();
    if (!begun && !heard.empty()) begun = now;
    const bool silent = faults.silent(now);
    if (!heard.empty() && !silent) wire.send(faults.spoil(device->receive(heard, now)), now);
    wire.deliver(now, *plug);
    if (now < due) continue;
    // What lies between the device's measurements is never seen; after the end the hand stays.
    while (next && begun && next->stamp.time_since_epoch() <= due - *begun) {
      current = std::move(next);
      next = source.frame(++n + 1);
    }
    if (!wire.busy(now)) {
      const auto records = device->measure(faults.spoil(*current), now);
      if (!silent)
        for (const std::string& record : records) wire.send(faults.spoil(record), now);
    }
    tick = std::max(tick + 1, static_cast<std::uint64_t>(to_seconds(now) * options.rate));
  }
  return {};
}

}  // namespace prehend::glove
