#pragma once

#include "common/model/grasp_candidates.hpp"
#include "services/mapping/core/mapping.hpp"

namespace prehend::mapping {

/// The mirror in which a left robot hand is the right one that the mapping knows: the plane x = x_W
/// of the table, in which the glove makes a right hand of a left one. What comes goes in by it,
/// what is answered comes out; joints, DoFs and sizes stay. Twice is the same again.
class Mirror {
 public:
  explicit Mirror(double x_W) : x_W_(x_W) {}  // m

  Pose pose(const Pose& X_W) const;
  Detection detection(Detection detection) const;
  RobotState state(RobotState state) const;
  std::vector<Capsule> capsules(std::vector<Capsule> in_W) const;
  Command command(Command command) const;
  /// Objects are their own mirror images.
  model::GraspCandidates candidates(model::GraspCandidates planned) const;

 private:
  double x_W_;
};

}  // namespace prehend::mapping
