#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::mapping {

using model::Capsule;

/// Where on the line from a to b the point nearest to p is, 0 to 1.
double nearest(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& p);

/// From the line of the other to that of this one, where these are nearest to each other.
Eigen::Vector3d between_lines(const Capsule& one, const Capsule& other);

/// m, negative where they overlap.
double distance(const Capsule& one, const Capsule& other);

/// The capsule that stands for a part of a finger, in the part's frame.
Capsule finger_capsule(const model::Shape& shape);

/// A robot hand as capsules, palm and all.
class HandCapsules {
 public:
  explicit HandCapsules(const model::HandModel& hand);

  /// Where they are when the hand's base is at X_WB; in W. dof: of that hand.
  std::vector<Capsule> at(const Pose& X_WB, const Eigen::VectorXd& dof) const;
  /// None of them ever reaches further from the base's origin, m.
  double reach() const { return reach_; }

 private:
  struct Part {
    std::size_t link = 0;
    Capsule capsule_L;
  };
  model::HandModel hand_;
  std::vector<Part> parts_;
  double reach_ = 0;
};

}  // namespace prehend::mapping
