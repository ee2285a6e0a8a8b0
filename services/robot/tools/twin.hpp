#pragma once

#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/config.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot {

/// Joins an emulated robot with a simulated hand of another name: its motors drive the joints of
/// that, and are where those are, so that what is grasped there stops them. The simulated hand's
/// base is where the robot's commands say that it is carried.
class Twin {
 public:
  /// hand: what the robot is called in the lab; twin: what the simulated one is.
  static Expected<std::unique_ptr<Twin>> create(const service::Config& config,
                                                const model::HandModel& hand,
                                                const std::string& name, const std::string& twin);
  ~Twin();

  /// Called often.
  void exchange(Emulator& robot);

 private:
  struct State;
  explicit Twin(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Where the drives of a simulated hand are: a clutch may have let go of the joints that lead.
Eigen::VectorXd drives_of(const model::HandModel& hand, const std::vector<double>& joints);

}  // namespace prehend::robot
