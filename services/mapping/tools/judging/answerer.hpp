#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/gate/command_gate.hpp"
#include "services/mapping/core/mapping.hpp"

namespace prehend::mapping {

/// What a mapping hears at one time of a take.
struct Told {
  std::optional<Detection> detection;
  std::optional<RobotState> state;
  std::optional<Posture> posture;
};

/// A mapping that is judged, whatever it is.
class Answerer {
 public:
  virtual ~Answerer() = default;
  /// Asked before every step of the world: what is commanded now. Fails when nothing more will
  /// come.
  virtual Expected<std::vector<gate::Command>> answer(const Told& told, Time now) = 0;
};

/// Key of robot/command and robot/state in every take.
inline constexpr const char* benchmarked_hand_name = "hand";

/// Our own mapping, called as the live process calls it: detection and state first, then the
/// posture.
class OwnMapping : public Answerer {
 public:
  OwnMapping(const model::HandModel& hand, Mapping mapping)
      : hand_(hand), mapping_(std::move(mapping)) {}

  Expected<std::vector<gate::Command>> answer(const Told& told, Time now) override {
    // Modes that know no objects are told of them all the same.
    if (told.detection) (void)mapping_.on_detection(*told.detection);
    if (told.state) (void)mapping_.on_state(*told.state);
    if (!told.posture) return {};
    const auto command = mapping_.on_posture(*told.posture, now);
    if (!command) return {};
    return std::vector{gate::Command{{},
                                     ++sequence_,
                                     command->stamp,
                                     benchmarked_hand_name,
                                     hand_.name(),
                                     {command->dof, command->X_WB}}};
  }

 private:
  const model::HandModel& hand_;
  Mapping mapping_;
  std::uint64_t sequence_ = 0;
};

}  // namespace prehend::mapping
