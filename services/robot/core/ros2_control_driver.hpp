#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/driver.hpp"
#include "services/robot/core/kept.hpp"
#include "services/robot/core/silence.hpp"

namespace prehend::robot::ros2_control {

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options);

/// Joints of a controller manager of ROS 2: what is heard are its joint states, what is said are
/// trajectories of one point for its joint_trajectory_controller, which holds there when no more
/// come. The joint that leads a DoF has the name that it has in the hand's description. Nothing is
/// said before the first command.
class Driver final : public robot::Driver {
 public:
  Driver(const model::HandModel& hand, const DriverOptions& options);

  void connected(Time now) override;
  void disconnected(const std::string& why) override;
  std::string step(std::string_view heard, Time now) override;
  std::string farewell() override;
  void home() override;
  void follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) override;
  void hold() override;

 private:
  struct Motion {
    std::string joint;  // in ROS 2
    double position = 0, velocity = 0, effort = 0;
    double goal = 0, share = 1;  // of the effort that it may press with
    Kept kept;                   // from going to its goal
  };
  void suspect(std::string why, Time now);
  void hear(std::string_view message, Time now);
  bool is_plausible(const std::vector<double>& positions, Time now) const;
  void observe(Motion& motion, double position, std::optional<double> velocity, Time now);
  std::optional<std::string> out_of_range() const;
  std::optional<std::string> what_is_wrong(Time now) const;
  void publish(Time now);
  std::string tell() const;
  double bounded(const Motion& motion) const;
  const model::HandDof& dof_of(const Motion& motion) const;

  const model::HandModel& hand_;
  DriverOptions options_;
  std::vector<Motion> motions_;  // a DoF each
  std::string suspicion_;        // why the last one was not sound,
  Time suspected_{};             // and when that was
  Silence silence_;
  Time told_{};
  bool joined_ = false, known_ = false;  // known: it has been heard since it was lost
  bool tells_effort_ = false;
  bool commanded_ = false;
};

}  // namespace prehend::robot::ros2_control
