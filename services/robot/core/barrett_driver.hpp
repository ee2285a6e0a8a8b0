#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/barrett_protocol.hpp"
#include "services/robot/core/driver.hpp"
#include "services/robot/core/kept.hpp"
#include "services/robot/core/silence.hpp"

namespace prehend::robot::barrett {

/// Refuses hands that have not the four drives of a BarrettHand.
Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options);

/// How hard a motor is driven to where it shall be, by velocities: those that follow the target,
/// and more the further it is behind. A motor that is kept from moving is driven slowly, so that
/// its torque, which grows with the missing velocity, stays bounded. Counts and seconds. Pure.
class MotorControl {
 public:
  struct Limits {
    double speed = 0;    // counts/s
    double press = 0;    // counts/s, of a motor that is kept from moving
    double squeeze = 0;  // counts, past a contact, for the full effort
    double counts_per_radian = 1;
  };
  explicit MotorControl(const Limits& limits) : limits_(limits) {}

  /// The hand was away: nothing is known of it any more.
  void forget() { *this = MotorControl(limits_); }
  /// Where it is by now.
  void observe(double position, Time now);
  /// Where it shall be; share: of the full effort.
  void follow(double target, double share, Time now);
  void hold();
  /// It is told to stand still until the next command, whatever its target is.
  void rest() { commanded_ = 0; }
  void close_no_further() { target_ = std::min(target_, position_); }
  /// The velocity to command, counts/s.
  double command(Time now);

  double position() const { return position_; }
  double velocity() const { return velocity_; }
  /// Of what it may press with: -1 to 1; 0 as long as it moves.
  double effort() const;
  bool stalled() const { return kept_.stalled(); }
  /// Far from where it shall be, and for long.
  bool stuck() const;

 private:
  void watch(Time now);

  Limits limits_;
  double position_ = 0, velocity_ = 0;
  double target_ = 0, ahead_ = 0;  // counts, counts/s
  double share_ = 1, commanded_ = 0;
  Time seen_{}, told_{};
  Kept kept_;
  bool known_ = false;
};

/// Speaks with the hand: wakes it, asks who it is and how it fares, sets up RealTime mode, and
/// exchanges a block for a block.
class Driver final : public robot::Driver {
 public:
  Driver(const model::HandModel& hand, const DriverOptions& options);

  void connected(Time now) override;
  void disconnected(const std::string& why) override;
  std::string step(std::string_view heard, Time now) override;
  std::string farewell() override { return std::string(abort_surely); }
  void home() override;
  void follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) override;
  void hold() override;

 private:
  enum class Talk {
    silent,   // no line
    waking,   // whatever it did is ended
    version,  // these are asked one after the other
    status,
    heat,
    idle,  // nothing to ask
    homing,
    setting,  // RealTime mode, line by line
    position,
    entering,  // into RealTime mode
    probing,   // how long a feedback block is
    looping
  };
  std::string ask(Talk talk, const std::string& line, Duration patience, Time now);
  std::string interrupt(Time now);
  std::string wake(Time now);
  std::string converse(Time now);
  std::string answered(const Reply& reply, Time now);
  std::string judge_status(const Reply& reply, Time now);
  std::string judge_heat(const Reply& reply, Time now);
  std::string next_setting(Time now);
  std::string rest(Time now);
  std::string enter(Time now);
  std::string probe(Time now);
  std::string loop(Time now);
  std::string exchange_block(Time now);
  bool take_block(Time now);
  void accept(const Feedback& feedback, Time now);
  bool plausible(const Feedback& feedback, Time now) const;
  bool is_confirmed(const Feedback& feedback);
  std::string miss(Time now);
  void reject(const char* why, Time now);
  std::string lose(const std::string& why, Time now);
  void publish(Time now);
  std::string too_hot() const;

  const model::HandModel& hand_;
  DriverOptions options_;
  std::vector<MotorControl> control_;
  Talk talk_ = Talk::silent;
  std::string heard_, line_;
  std::optional<double> temperature_;
  Silence silence_;
  Time asked_{}, heard_at_{};
  Time deaf_until_{};  // what comes before is an answer that was given up
  std::optional<Feedback> doubted_, doubted_before_;  // in this answer, in the one before
  Duration patience_{};
  std::size_t setting_ = 0;
  int temperature_bytes_ = 0;
  bool standing_ = false;  // told to, since an answer did not come in time
  bool waiting_ = false, is_homed_ = false, hot_ = false;
  bool wants_home_ = false, gives_up_ = false;  // homing
};

}  // namespace prehend::robot::barrett
