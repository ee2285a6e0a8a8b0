#pragma once

#include <optional>
#include <string>

#include "common/base/random.hpp"
#include "common/serial/line_faults.hpp"
#include "common/serial/wire.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot {

/// What goes wrong with robots and their lines. Times are s after the start; negative: never.
struct FaultOptions {
  serial::LineFaults line;  // of the bytes on the wire
  double late = 0;          // share of answers that come late_by after their time
  double late_by = 0.15;    // s, that these are late
  double silent_at = -1;    // from when on it says and hears nothing
  double silent_for = 1;    // s, that this lasts
  double cut_at = -1;       // when the cable is pulled out; the robot keeps its power
  double cut_for = 2;       // s, until it is plugged in again
  double hot_at = -1;       // when its motors are hot
  double hot_for = 2;       // s, until they have cooled down
  double hot = 80;          // °C, that they then have
  double stuck_at = -1;     // when a joint does not move any more
  double stuck_for = 3;     // s, until it does
  std::size_t stuck = 0;    // DoF of that joint
  double restart_at = -1;   // when it is switched off and on, and forgets
  std::uint64_t seed = 1;   // the same makes the same faults
};

/// An emulated robot and its line of a certain speed, with what goes wrong there. Pure: times are
/// those since the start. Keeps a reference to the robot.
class FaultyRobot {
 public:
  /// baud: bits per second, both ways; 0: bytes take no time.
  FaultyRobot(Emulator& robot, const FaultOptions& faults, int baud);

  /// Is the cable pulled out? What is on the line then is lost.
  bool is_cut(Duration now) const;
  /// The host has written that: bytes, or one message.
  void hear(std::string said, Duration now);
  /// Time passes: what has reached the robot is answered.
  void step(Duration now);
  /// What has reached the host next; nothing: nothing more by now.
  std::optional<std::string> take(Duration now) { return to_host_.take(now); }
  /// When something arrives next at either end, but `otherwise` at the latest.
  Duration next(Duration otherwise) const { return to_host_.next(to_robot_.next(otherwise)); }

  /// May be changed between steps.
  FaultOptions& faults() { return faults_; }

 private:
  Emulator& robot_;
  FaultOptions faults_;
  int baud_;
  Random random_;
  serial::Wire to_robot_, to_host_;
  bool restarted_ = false;
};

}  // namespace prehend::robot
