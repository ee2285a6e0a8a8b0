#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/driver.hpp"
#include "services/robot/core/dynamixel_protocol.hpp"
#include "services/robot/core/dynamixel_wiring.hpp"
#include "services/robot/core/kept.hpp"
#include "services/robot/core/silence.hpp"

namespace prehend::robot::dynamixel {

/// Refuses a hand whose wiring is not that of its DoFs.
Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options);

/// Speaks with the servos of a hand: asks each who it is and how it fares, lets all hold where they
/// are, and then sends goals and reads places, in one breath. Their encoders are absolute, so there
/// is nothing to home. Servos go to a place by themselves, with at most the current that the effort
/// asks for; nobody speaking to them, they stop by their own watchdog.
class Driver final : public robot::Driver {
 public:
  Driver(const model::HandModel& hand, const DriverOptions& options, std::vector<Servo> servos);

  void connected(Time now) override;
  void disconnected(const std::string& why) override;
  std::string step(std::string_view heard, Time now) override;
  std::string farewell() override { return stay(); }
  void home() override;
  void follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) override;
  void hold() override;

 private:
  enum class Talk {
    silent,      // no line
    resting,     // something was wrong; it is asked again soon
    setting_up,  // servo by servo
    looping,
    explaining  // a servo is asked what is wrong with its hardware
  };
  /// What a servo is asked and told while it is set up: all servos the first part, before any has
  /// its torque, then all the second.
  enum class Step {
    ping,
    hardware,
    heat,
    limit,
    mode,
    let_go,  // only where the mode has to be set
    set_mode,
    unwatch,  // an old alarm of its watchdog ends
    place,
    speed,
    current,
    goal,
    torque,
    watch,
  };
  struct Motion {
    Servo servo;
    double position = 0, velocity = 0, current = 0;  // pulses, pulses/s, units of current
    int goal = 0, limit = 0;                         // pulses; units of current, by the servo's own
    int allowed = 0;                                 // units of current, for the effort
    Kept kept;                                       // from going to its goal
  };

  std::string begin(Time now);
  std::string ask(Time now);
  Packet question() const;
  std::string set_up(Time now);
  std::string judge(const Packet& answer, Time now);
  std::string next_step(Time now);
  std::optional<std::string> judge_place(const Packet& answer);
  std::string loop(Time now);
  std::string cycle(Time now);
  std::string take(Time now);
  std::string accept(Time now);
  bool plausible(Time now) const;
  void observe(Motion& motion, const std::string& bytes, Time now);
  void publish(Time now);
  std::string explain(Time now);
  std::string lose(const std::string& why, Time now);
  bool stuck(const Motion& motion) const;
  std::string stay();
  std::string sync_write(const Item& item, int Motion::*value) const;
  std::string sync_read(const Item& item) const;
  std::string named(const Motion& motion) const;
  bool too_hot(int celsius);
  Duration due(std::size_t bytes) const;

  const model::HandModel& hand_;
  DriverOptions options_;
  std::vector<Motion> motions_;
  Parser parser_;
  Talk talk_ = Talk::silent;
  Step step_ = Step::ping;
  std::size_t at_ = 0;  // the servo that is set up
  int tries_ = 0;
  std::vector<std::string> answers_;  // of the motions, as they came
  std::optional<double> temperature_;
  Silence silence_;
  Time asked_{}, checked_{};
  Item asks_ = table::motion;   // all servos, in this cycle
  Item check_ = table::motion;  // that was asked last beside motions
  bool armed_ = false, waiting_ = false, wants_home_ = false;
  bool hot_ = false, tells_current_ = true;
};

}  // namespace prehend::robot::dynamixel
