#include "services/robot/devices/emulation.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "common/serial/wire.hpp"

namespace prehend::robot {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Duration step = std::chrono::milliseconds(2);
constexpr double warm = 32;  // °C

}  // namespace

Expected<void> emulate(const EmulationOptions& options, Emulator& robot,
                       const std::function<bool()>& stopped) {
  const FaultOptions& faults = options.faults;
  const Clock::time_point start = Clock::now();
  Random random(faults.seed);
  std::unique_ptr<serial::Plug> plug;
  serial::Wire wire(options.baud);
  bool restarted = false;
  while (!stopped()) {
    Duration now = std::chrono::duration_cast<Duration>(Clock::now() - start);
    robot.heat(serial::within(now, faults.hot_at, faults.hot_for) ? faults.hot : warm);
    robot.block(faults.stuck, serial::within(now, faults.stuck_at, faults.stuck_for));
    if (!restarted && faults.restart_at >= 0 && now > seconds(faults.restart_at)) {
      robot.restart();
      restarted = true;
    }
    const bool cut = serial::within(now, faults.cut_at, faults.cut_for);
    if (cut) {
      plug.reset();
      wire = serial::Wire(options.baud);
    } else if (!plug) {
      auto made = options.plug_in();
      if (!made) return tl::unexpected(made.error());
      plug = std::move(*made);
      if (options.on_plugged) options.on_plugged(plug->where());
    }
    std::string heard;
    if (plug)
      heard = plug->read(std::clamp(wire.next(now + step) - now, Duration::zero(), step));
    else
      std::this_thread::sleep_for(step);
    now = std::chrono::duration_cast<Duration>(Clock::now() - start);
    std::string said = robot.pass(now);
    const bool silent = serial::within(now, faults.silent_at, faults.silent_for);
    if (!heard.empty() && !silent) said += robot.receive(heard, now);
    if (plug && !said.empty() && !silent) {
      const bool late = random.uniform() < faults.late;
      wire.send(serial::spoil(std::move(said), faults.line, random), now,
                late ? seconds(faults.late_by) : Duration::zero());
    }
    if (plug) wire.deliver(now, *plug);
    if (options.on_step) options.on_step(robot);
  }
  return {};
}

}  // namespace prehend::robot
