#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/model/scene.hpp"
#include "common/stage/arm.hpp"
#include "idl/Arm.h"
#include "idl/Glove.h"
#include "idl/Operation.h"
#include "idl/Perception.h"
#include "idl/Planning.h"
#include "idl/Robot.h"
#include "idl/World.h"
#include "services/cli/service/outcome.hpp"

namespace prehend::cli {

/// Watches a lab and says what its demonstration came to. Pure: is handed what the topics say.
class Observer {
 public:
  /// truth: what really stands on the table, where that is known.
  explicit Observer(std::optional<model::Scene> truth = std::nullopt);

  /// This arm carries the hand.
  void expect_arm(const model::ArmModel& arm) { arm_.emplace(arm); }

  void hear(const v1::GloveFrame& frame);
  void hear(const v1::ObjectDetection& detection);
  void hear(const v2::HandCommand& command);
  void hear(const v1::GraspReport& report);
  void hear(const v2::GraspCandidates& planned);
  void lost_object(std::uint32_t track);
  void hear(const v1::ArmState& state);
  void hear(const v1::ServiceStatus& status);
  void lost_service(const std::string& key);

  /// The service says of itself that it works.
  bool is_up(std::string_view service) const;
  /// It has counted at least one of these.
  bool has_counted(std::string_view service, std::string_view what) const;
  /// A command that follows the hand (not: hold) has been heard.
  bool commanded() const;
  /// Something is seen, and of all that is seen the planner looks for no better grasps. That there
  /// are none counts once it has been so for a while: a picture later it may plan after all.
  bool planned() const;
  /// Names of what is seen and is not planned for yet.
  std::string unplanned() const;
  /// Of what is seen and gets no planned grasp: its name, and why.
  std::vector<std::pair<std::string, std::string>> without_plan() const;
  /// The first grasp has been judged.
  bool judged() const { return report_.has_value(); }
  /// The simulation has told its latency since the grasp closed.
  bool latency_is_in() const;
  std::uint64_t frames() const { return frames_; }
  const std::map<std::string, v1::ServiceStatus>& services() const { return services_; }

  /// What goes on, in a few words.
  std::string progress() const;
  Outcome outcome() const;

 private:
  const v1::ObjectDetection* recognised() const;
  const v1::ServiceStatus* service(std::string_view name) const;
  bool is_planned(const v1::ObjectDetection& seen) const;

  std::optional<model::Scene> truth_;
  std::map<std::string, v1::ServiceStatus> services_;                  // by key
  std::map<std::string, std::deque<v1::ObjectDetection>> detections_;  // by name, in order of stamp
  std::map<std::uint32_t, v1::ObjectDetection> seen_;                  // by track, newest
  std::map<std::uint32_t, v2::GraspCandidates> planned_;               // by track
  std::optional<v2::HandCommand> command_;
  std::optional<v1::GraspReport> report_;
  std::optional<stage::ArmUse> arm_;
  std::string device_;
  std::uint64_t frames_ = 0;
};

}  // namespace prehend::cli
