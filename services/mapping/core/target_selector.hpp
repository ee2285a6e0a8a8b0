#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/pose.hpp"
#include "common/model/grasp_candidates.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/arbitration.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/core/object_tracks.hpp"

namespace prehend::mapping {

struct TargetOptions {
  /// An object comes within reach when its nearest grasp is at most this far from the hand's grasp
  /// frame, m.
  double enter = 0.20;
  /// The object that is reached for goes out of reach beyond this distance, m.
  double leave = 0.25;
  /// An object comes within reach when its nearest grasp is turned by at most this angle, rad.
  double enter_angle = 0.8;
  /// The object that is reached for goes out of reach beyond this angle, rad.
  double leave_angle = 1.1;
  /// Another object takes over only when it is nearer by this distance, m.
  double prefer = 0.03;
};

/// An object within reach, and how to grasp it.
struct GraspTarget {
  ObjectTrack object;
  double distance = 0;           // m, from the hand to its nearest grasp
  Pose X_WG = Pose::Identity();  // that grasp
  Pose X_OG = Pose::Identity();  // the same on the object
  Pose X_GR = Pose::Identity();  // where this hand stands in it: as planned, or PalmOffset
  std::optional<model::GraspCandidate> planned;  // the fingers of this grasp
};

/// Chooses the object that the hand reaches for, and stays with it. Keeps references to the hand
/// and the model.
class TargetSelector {
 public:
  TargetSelector(const model::HandModel& hand, const MappingModel& model,
                 const TargetOptions& options)
      : hand_(hand), model_(model), options_(options) {}

  /// The object within reach of the human grasp frame X_WG: the nearest one; while one is reached
  /// for, that one or none. Objects whose shape the model does not know, and for which nothing is
  /// planned, are not there.
  std::optional<GraspTarget> select(const ObjectTracks& tracks, const model::CandidateBook& planned,
                                    const Pose& X_WG) const;

  /// Takes what select() gave for what is reached for, after Arbitration's phase went from `before`
  /// to `now`. A grip keeps its object as it was seen last: a hand hides what it grips.
  void update(const std::optional<GraspTarget>& seen, Phase before, Phase now);

  /// What is reached for or gripped, as it was seen last.
  const std::optional<GraspTarget>& engaged() const { return engaged_; }

 private:
  std::optional<GraspTarget> within_reach(const ObjectTrack& track,
                                          const model::CandidateBook& planned, const Pose& X_WG,
                                          bool engaged) const;

  const model::HandModel& hand_;
  const MappingModel& model_;
  TargetOptions options_;
  std::optional<GraspTarget> engaged_;
};

}  // namespace prehend::mapping
