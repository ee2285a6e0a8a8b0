#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/robot/gatekeeper.hpp"
#include "common/service/shell.hpp"
#include "services/robot/core/driver.hpp"
#include "services/robot/devices/line.hpp"
#include "services/robot/service/options.hpp"

namespace prehend::robot {

/// The shell around a robot's driver: what the gate lets through goes to the robot, what the robot
/// says to the lab. A robot that is no more ready is stopped until somebody releases it.
class Service {
 public:
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);

 private:
  Service(service::Shell& shell, Connection connection);
  Expected<void> start();
  Expected<void> obey(const v2::HandCommand& command, const gate::Place& place, Time now);
  std::optional<gate::Place> where() const;
  void on_tick(Time now);
  void watch(Time now);
  void publish();

  service::Shell& shell_;
  Connection connection_;
  Driver& driver_;
  Line line_;
  std::unique_ptr<Gatekeeper> gate_;
  service::Shell::Output<v1::HandState> states_;
  service::Shell::Output<v1::HandTouch> touches_;
  std::string hand_name_;
  bool homes_;
  Phase phase_ = Phase::offline;
  std::string trouble_;
  Pose X_WB_;  // as it was commanded: somebody else carries the hand
  bool placed_ = false, holds_ = true;
  Time obeyed_{}, published_{};
  std::int64_t origin_ns_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace prehend::robot
