#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/gate/command_gate.hpp"
#include "common/service/config.hpp"

namespace prehend::robot {

/// A stop on disk, so that it outlives the process of the gate: a file of one line, as the audit
/// log has it. It is there exactly while the hand is stopped.
class KeptStop {
 public:
  /// Of one hand of this rig and domain, in safety.state. Fails where nothing can be written.
  static Expected<KeptStop> create(const service::Config& config, const std::string& hand);

  /// What is kept. A file that cannot be read or understood is a stop, too.
  std::optional<gate::CommandGate::Stop> recall() const;
  Expected<void> keep(const gate::CommandGate::Stop& stop) const;
  Expected<void> forget() const;

 private:
  KeptStop(std::filesystem::path file, std::string hand)
      : file_(std::move(file)), hand_(std::move(hand)) {}

  std::filesystem::path file_;
  std::string hand_;
};

}  // namespace prehend::robot
