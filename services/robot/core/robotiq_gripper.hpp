#pragma once

#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "services/robot/core/modbus_rtu.hpp"
#include "services/robot/core/robotiq_protocol.hpp"

namespace prehend::robot::robotiq {

/// What an emulated gripper does behind its registers, whoever carries them: it is activated by an
/// edge of rACT, opening and closing fully, goes where it shall, tells contact from arrival, and
/// has its faults.
class Gripper {
 public:
  Gripper(const model::HandModel& hand, const Kind& kind, bool activated, double velocity_scale);

  /// Its registers: the action as it was written, the status as it is now.
  modbus::Map map;

  /// Somebody spoke to it.
  void hear(Duration now);
  void pass(Duration now);
  double driven() const { return scale_.dof_of(driven_); }
  double measured() const { return scale_.dof_of(position_); }
  void measure(double dof);
  void block(bool blocked) { blocked_ = blocked; }
  void heat(double celsius) { hot_ = celsius > too_hot; }
  /// It was switched off and on.
  void restart();

 private:
  static constexpr double too_hot = 70;  // °C

  void obey(const Action& action);
  void move(double dt, double goal, double speed, double share);
  void activate(double dt);
  void watch_object(Duration now);
  void tell();

  Scale scale_;
  double squeeze_;  // counts past a contact, by which it presses with all its force
  double full_, velocity_scale_;
  Action action_;
  Status status_;
  double position_ = open_count, driven_ = open_count, seen_ = open_count;  // counts
  int leg_ = 0;  // of the activation: opens, closes, opens
  Duration now_{}, heard_{}, still_since_{};
  bool twin_ = false, blocked_ = false, hot_ = false, unheard_ = false;
};

}  // namespace prehend::robot::robotiq
