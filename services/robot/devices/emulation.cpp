#include "services/robot/devices/emulation.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace prehend::robot {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Duration step = std::chrono::milliseconds(2);

}  // namespace

Expected<void> emulate(const EmulationOptions& options, Emulator& robot,
                       const std::function<bool()>& stopped) {
  const Clock::time_point start = Clock::now();
  const auto passed = [&] { return std::chrono::duration_cast<Duration>(Clock::now() - start); };
  FaultyRobot faulty(robot, options.faults, options.baud);
  std::unique_ptr<serial::Plug> plug;
  while (!stopped()) {
    Duration now = passed();
    if (faulty.is_cut(now)) {
      plug.reset();
    } else if (!plug) {
      auto made = options.plug_in();
      if (!made) return tl::unexpected(made.error());
      plug = std::move(*made);
      if (options.on_plugged) options.on_plugged(plug->where());
    }
    std::string heard;
    if (plug)
      heard = plug->read(std::clamp(faulty.next(now + step) - now, Duration::zero(), step));
    else
      std::this_thread::sleep_for(step);
    now = passed();
    faulty.hear(std::move(heard), now);
    faulty.step(now);
    while (const auto said = faulty.take(now))
      if (plug) plug->write(*said);
    if (options.on_step) options.on_step(robot);
  }
  return {};
}

}  // namespace prehend::robot
