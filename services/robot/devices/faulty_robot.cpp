#include "services/robot/devices/faulty_robot.hpp"

#include <utility>

namespace prehend::robot {
namespace {

constexpr double warm = 32;  // °C

}  // namespace

FaultyRobot::FaultyRobot(Emulator& robot, const FaultOptions& faults, int baud)
    : robot_(robot),
      faults_(faults),
      baud_(baud),
      random_(faults.seed),
      to_robot_(baud),
      to_host_(baud) {}

bool FaultyRobot::is_cut(Duration now) const {
  return serial::within(now, faults_.cut_at, faults_.cut_for);
}

void FaultyRobot::hear(std::string said, Duration now) {
  if (!is_cut(now)) to_robot_.send(std::move(said), now);
}

void FaultyRobot::step(Duration now) {
  robot_.heat(serial::within(now, faults_.hot_at, faults_.hot_for) ? faults_.hot : warm);
  robot_.block(faults_.stuck, serial::within(now, faults_.stuck_at, faults_.stuck_for));
  if (!restarted_ && faults_.restart_at >= 0 && now > seconds(faults_.restart_at)) {
    robot_.restart();
    restarted_ = true;
  }
  std::string said = robot_.pass(now);
  if (is_cut(now)) {
    to_robot_ = to_host_ = serial::Wire(baud_);
    return;
  }
  const bool silent = serial::within(now, faults_.silent_at, faults_.silent_for);
  while (const auto heard = to_robot_.take(now))
    if (!silent) said += robot_.receive(*heard, now);
  if (said.empty() || silent) return;
  const bool late = random_.uniform() < faults_.late;
  to_host_.send(serial::spoil(std::move(said), faults_.line, random_), now,
                late ? seconds(faults_.late_by) : Duration::zero());
}

}  // namespace prehend::robot
