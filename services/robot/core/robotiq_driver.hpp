#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/robot/core/kept.hpp"
#include "services/robot/core/modbus_rtu.hpp"
#include "services/robot/core/polled_driver.hpp"
#include "services/robot/core/robotiq_protocol.hpp"

namespace prehend::robot::robotiq {

Expected<std::unique_ptr<robot::Driver>> create_2f85(const model::HandModel& hand,
                                                     const DriverOptions& options);
Expected<std::unique_ptr<robot::Driver>> create_2f140(const model::HandModel& hand,
                                                      const DriverOptions& options);

/// A gripper that goes to a place by itself, with a speed and a force, and says whether something
/// is between its fingers. It must be activated before: it opens and closes fully for that, so this
/// is its homing. What it holds it keeps holding, also when the wire is lost.
class Driver final : public PolledDriver {
 public:
  Driver(const model::HandModel& hand, const DriverOptions& options, const Kind& kind);

  std::string farewell() override { return stay(); }
  void home() override;
  void follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) override;
  void hold() override;

 private:
  enum class Homing { none, resets, activates };

  void begin(Time now) override;
  std::string question(Time now) override;
  void feed(std::string_view bytes) override { parser_.feed(bytes); }
  Heard hear(Time now) override;
  void forget() override { parser_.clear(); }
  std::string stay() override;
  std::optional<std::string> what_is_wrong() const override;

  bool take(const modbus::Frame& answer, Time now);
  void take(const Status& status, Time now);
  void judge();
  void judge_homing();
  void become_ready();
  void need_activation(const std::string& why);
  void observe(const Status& last, Time now);
  std::string tell(const Action& action);
  bool presses() const;
  bool must_tell() const;
  Action halt() const;

  Kind kind_;
  Scale scale_;
  std::uint8_t id_, speed_;
  modbus::Parser parser_{modbus::Side::answers};
  std::optional<Status> status_;         // none: not heard since it was lost
  std::optional<Action> wanted_, told_;  // told: it has said that it took this
  Action said_;                          // last
  modbus::Function asked_ = modbus::Function::read_input;
  Homing homing_ = Homing::none;
  double velocity_ = 0;
  Kept kept_;
  Time read_{}, homes_since_{};
};

}  // namespace prehend::robot::robotiq
