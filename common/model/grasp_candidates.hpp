#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/past_contact.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

/// A planned way in which the robot hand may take an object, as grasp/candidates says it.
struct GraspCandidate {
  Pose X_OG = Pose::Identity();  // the approach that it answers
  Pose X_OR = Pose::Identity();  // where the hand's own grasp frame stands, near it
  Eigen::VectorXd preshape;      // DoF values before the fingers close, rad or m
  Eigen::VectorXd dof;           // where they touch
  Eigen::VectorXd closing;       // of each: +1, -1, which way it closes, 0 if it rests
  double room = 0;               // share of small errors with which it holds as well
  /// How far past dof the fingers go on until something stops them, rad.
  double follow_through = full_follow_through;
};

/// Of an object, as it was when it was planned for.
struct GraspCandidates {
  std::uint32_t track = 0;
  Shape shape;
  std::vector<GraspCandidate> candidates;  // the one with the most room first
  std::string object = {};                 // its name
};

/// The same grasp of an object that looks the same from several sides: from where its approach is
/// nearest to X_OG.
GraspCandidate turned_to(const Shape& shape, const GraspCandidate& candidate, const Pose& X_OG);

/// What has been planned for which object, as the mapping and the performer take it.
class CandidateBook {
 public:
  /// Takes the place of what was known of this object. Refuses, all of them, values that are not
  /// finite, are not this hand's, or place the hand farther from its approach than a correction
  /// may go.
  Expected<void> observe(GraspCandidates planned, const HandModel& hand);
  void remove(std::uint32_t track) { known_.erase(track); }

  /// The candidate that answers a hand whose nearest grasp is X_OG (model::nearest_grasp), as it
  /// lies there: objects look the same from some sides. The one with the most room of those that
  /// come from there. None where nothing is planned for this object and approach, or where the
  /// object is now said to have quite another size.
  std::optional<GraspCandidate> answer(std::uint32_t track, const Shape& shape,
                                       const Pose& X_OG) const;

  /// All with room to spare for an object of that name and about that size, the one with the most
  /// room first; of the first such track. None: nothing is planned for it.
  std::vector<GraspCandidate> of(std::string_view object, const Shape& shape) const;

 private:
  std::map<std::uint32_t, GraspCandidates> known_;
};

}  // namespace prehend::model
