#pragma once

#include <vector>

#include "common/model/human_hand.hpp"
#include "common/model/shape.hpp"

namespace prehend::demonstration {

/// How fast a finger's joints bend beside each other.
struct Bending {
  double first = 1, second = 1.1, third = 0.7;  // from the palm to the tip
};

/// Fingers wrap an object: each bends until a segment touches, which then stays while the segments
/// behind it bend on.
model::HumanPosture wrapped(const model::HumanHand& hand, const model::HumanPosture& from,
                            const Bending& bending, const model::Shape& shape, const Pose& X_HO);

/// Where the tip of a finger shall be on an object.
struct TipPlace {
  model::Finger finger{};
  Eigen::Vector3d p_O = Eigen::Vector3d::Zero();  // m
};

/// A hand about an object.
struct Held {
  model::HumanPosture posture = model::HumanPosture::Zero();
  Pose X_HO = Pose::Identity();
};

/// How far an object readily is from where it is comfortable.
struct Slack {
  Eigen::Vector3d place_H = Eigen::Vector3d::Constant(0.02);  // m
  double turn = 0.26;                                         // rad
};

/// Fingertips reach their places, as near to a comfortable posture and with the object as near to a
/// comfortable place as they can: damped least squares. Joints keep their limits, so a tip may stay
/// short of its place.
Held pinched(const model::HumanHand& hand, const Held& comfortable,
             const std::vector<TipPlace>& places, const Slack& slack);

}  // namespace prehend::demonstration
