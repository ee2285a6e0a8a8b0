#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"

namespace prehend::mapping {

/// How far the fingers of a robot hand still are from an object that is known, by geometry alone.
/// Round parts of a finger count as capsules, boxes by points on their edges and middles, 8 mm
/// apart, so that a distance is at most 2 mm too large around the catalogue's objects. Keeps a
/// reference to the hand.
class FingerDistances {
 public:
  explicit FingerDistances(const model::HandModel& hand);

  int fingers() const { return static_cast<int>(hand_.fingertips().size()); }
  /// The finger that a DoF moves; -1: several, or none.
  int finger_of(std::size_t dof) const { return finger_of_[dof]; }

  /// Distance between each finger and the object, m, negative where they overlap; infinite for a
  /// finger without collision shapes. X_BO: the object in the hand's base.
  Eigen::VectorXd distances(const Eigen::VectorXd& dof, const model::Shape& shape,
                            const Pose& X_BO) const;

 private:
  /// A ball in a link: what stands for a small piece of it.
  struct Ball {
    Eigen::Vector3d p_L;
    double radius = 0;
  };
  struct Link {
    int link = 0, finger = 0;
    std::vector<Ball> balls;
  };

  const model::HandModel& hand_;
  std::vector<Link> links_;
  std::vector<int> finger_of_;  // of each DoF
};

}  // namespace prehend::mapping
