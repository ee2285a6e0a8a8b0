#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/service/config.hpp"
#include "services/mapping/tools/judging/answerer.hpp"

namespace prehend::mapping {

struct ExternalOptions {
  const service::Config* lab = nullptr;  // whose domain, network and rig
  std::string model;                     // kind of robot hand
  std::string user;                      // whose take it is
  /// Starts the mapping, for this take alone, in a rig of its own that PREHEND_LAB_RIG names to it;
  /// empty: it is there already, in the lab's rig.
  std::string command;
  std::filesystem::path log;  // takes what the command says
  /// Time is the topic lab/clock, which the mapping answers as `service`; else it is the time here.
  bool lockstep = false;
  std::string service = "mapping";  // its name in lab/progress
};

/// Any process that reads hand/posture, and object/detection and robot/state if it likes, and
/// writes robot/command. Of one take, from one thread.
class ExternalMapping : public Answerer {
 public:
  /// Returns when it is there. Fails when it does not come within 20 s, or ends.
  static Expected<std::unique_ptr<ExternalMapping>> meet(const ExternalOptions& options);
  ~ExternalMapping() override;

  /// Live, it returns when this time of the take has come.
  Expected<std::vector<gate::Command>> answer(const Told& told, Time now) override;
  /// How far the time here was ahead of the take's at most: the world was too slow by so much.
  Duration lag() const;

 private:
  struct State;
  explicit ExternalMapping(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::mapping
