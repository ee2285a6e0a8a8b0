#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/dds/participant.hpp"
#include "common/gate/command_gate.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/shell.hpp"
#include "idl/Robot.h"

namespace prehend::robot {

/// What the gate stands before, simulated or real. Called by the shell.
struct Robot {
  /// Obeys a command: `place` is what the gate has left of it.
  std::function<Expected<void>(const v1::HandCommand& command, const gate::Place& place, Time now)>
      obey;
  /// Where the hand is kept now; nothing as long as it may be put anywhere.
  std::function<std::optional<gate::Place>()> where;
};

/// The gate between robot/command and a robot hand, with all that the lab hears of it: counts, by
/// reason, of what was refused or cut, and a status that says whether the hand is led. Every
/// service that moves a hand has one.
class Gatekeeper {
 public:
  /// hand: key of its topics. Both references must outlive it.
  static Expected<std::unique_ptr<Gatekeeper>> create(service::Shell& shell,
                                                      const model::HandModel& hand,
                                                      const std::string& name, Robot robot);

  /// From the service's tick: says what is missing, or is running again.
  void look_around(Time now);

 private:
  Gatekeeper(service::Shell& shell, gate::CommandGate gate, Robot robot);
  void on_command(const v1::HandCommand& message, const dds::SampleInfo& info);
  void refuse(gate::Refusal refusal, const dds::SampleInfo& info, Time now);
  void obey(const v1::HandCommand& message, const dds::SampleInfo& info, const gate::Passed& passed,
            Time now);
  std::string missing(Time now) const;

  /// A command that was not obeyed.
  struct Refused {
    std::string why, writer;
    Time at{};
  };

  service::Shell& shell_;
  Robot robot_;
  gate::CommandGate gate_;
  std::uint64_t leads_ = 0;         // as counted in the status
  std::string leader_;              // by name
  Time last_obeyed_;                // or when somebody must have commanded at last
  std::optional<Refused> refused_;  // the last one
  std::optional<Refused> second_;   // of a second writer
  std::string missing_;
};

}  // namespace prehend::robot
