#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/ros2/joints.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot::ros2_control {

/// A controller manager with a joint_trajectory_controller and a joint_state_broadcaster, as their
/// topics show them: each trajectory replaces the one before, from where the joints are; its last
/// point is held. What does not name exactly the controller's joints is refused.
class Emulator final : public robot::Emulator {
 public:
  Emulator(const model::HandModel& hand, const EmulatedOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::string pass(Duration now) override;
  Eigen::VectorXd driven() const override;
  Eigen::VectorXd measured() const override;
  void measure(const Eigen::VectorXd& dof) override;
  void block(std::size_t dof, bool blocked) override;
  void heat(double) override {}  // nobody tells temperatures
  void restart() override;

  int refused() const { return refused_; }  // trajectories

 private:
  struct Joint {
    std::string name;
    double position = 0, driven = 0, velocity = 0;
    double squeeze = 0;  // by which the drive is ahead of what holds it
    double fastest = 0;
    bool blocked = false;
  };
  Eigen::VectorXd wanted(Duration now) const;

  EmulatedOptions options_;
  std::vector<Joint> joints_;
  ros2::JointTrajectory trajectory_;  // in the order of joints_
  Eigen::VectorXd begun_from_;
  Duration begun_{}, now_{}, told_{};
  int refused_ = 0;
  bool twin_ = false;
};

}  // namespace prehend::robot::ros2_control
