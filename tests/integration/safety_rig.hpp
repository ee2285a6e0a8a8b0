#pragma once

#include <optional>
#include <string>

#include "common/convert/convert.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {

/// Where the hand's base is at first, m.
inline const Eigen::Vector3d beginning(0, -0.3, 0.5);

/// For tests of who leads: on a loaded machine a leader may be silent for longer than 0.3 s.
inline const Strings patient{"gate.max_silence=2"};

/// A simulation, what it says, and commands and orders for it.
class SafetyRig : public Rig {
 protected:
  /// The hand open, its base at p; counted, and of now.
  v2::HandCommand command(const Eigen::Vector3d& p);
  /// What has been said since.
  void listen();
  /// Sends what `next` makes every 20 ms until the condition holds.
  bool send(dds::Writer<v2::HandCommand>& writer, double limit_s,
            const std::function<v2::HandCommand()>& next, const std::function<bool()>& condition);
  /// Listens until the condition holds.
  bool wait(double limit_s, const std::function<bool()>& condition);
  /// A simulation whose hand follows our commands.
  void start_hand(const Strings& sets = {});
  /// A lab of glove, mapping and simulation whose hand moves.
  void start_lab(const Strings& sets = {});

  Eigen::Vector3d base() const { return convert::from_message(state_.X_WB().position()); }
  /// Of a rate in the simulation's status; 0: it is not there.
  std::uint64_t total(const std::string& rate) const;
  std::uint64_t dropped(const std::string& reason) const;
  /// It is degraded, and says so with these words.
  bool says(const std::string& words) const;

  std::uint64_t sequence_ = 0;
  dds::Writer<v2::HandCommand> commands_ = writer(dds::robot_command);
  dds::Reader<v1::HandState> states_ = reader(dds::robot_state);
  dds::Reader<v1::GateState> gates_ = reader(dds::robot_gate);
  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
  v1::HandState state_;
  v1::GateState gate_;
  v1::ServiceStatus status_;  // of the simulation
  int heard_ = 0;             // states
  /// The largest changes from one state to the next since they were set to 0: of the base, m/s, and
  /// of a DoF, rad/s.
  double base_speed_ = 0, dof_speed_ = 0;
  std::string scene_;
  std::optional<stage::Process> simulation_, mapping_, glove_;
};

}  // namespace prehend::integration
