#pragma once

#include "services/mapping/core/retargeting/following_tips.hpp"

namespace prehend::mapping {

enum class Method {
  cartesian,  // robot fingertips go where the human ones are (inverse_kinematics.hpp)
  vector      // vectors from palm to fingertips match, scaled to the hand (vector_matching.hpp)
};

/// Answers fingertips with a robot posture, without anything having been trained. A value: it
/// remembers nothing, what came before is told. Keeps a reference to the hand.
class Retargeter {
 public:
  /// Fails when the hand does not say which human fingers its fingertips follow.
  static Expected<Retargeter> create(const model::HandModel& hand, Method method);

  /// p_GT: human fingertips. p_GH: where the back of that hand is. before: the DoFs' last values.
  /// The answer is within the hand's limits. Fails when a fingertip that is followed is missing or
  /// not finite.
  Expected<Eigen::VectorXd> answer(const HumanTips& p_GT, const Eigen::Vector3d& p_GH,
                                   const Eigen::VectorXd& before) const;

 private:
  Retargeter(FollowingTips tips, Method method);

  FollowingTips tips_;
  Method method_;
  double scale_ = 1;  // of vectors: how much longer the open robot hand is than a human one
};

}  // namespace prehend::mapping
