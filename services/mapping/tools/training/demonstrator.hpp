#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/base/pose.hpp"
#include "common/base/random.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/shape.hpp"
#include "services/mapping/core/features.hpp"
#include "services/mapping/core/grasp_type.hpp"

namespace prehend::mapping {

/// How people and the sensors on their hands differ.
struct DemonstratorOptions {
  double scale_sigma = 0.07;      // of hand sizes; adults, drawn within two sigma
  double scale_error = 0.02;      // sigma of the calibrated scale's relative error
  double mounting = 0.005;        // m, each sensor sits up to so far from its place
  double mounting_turn = 0.1745;  // rad, and the one on the back of the hand so crookedly
  double noise = 0.001;           // m, sigma a coordinate, after the glove's filter
  double posture_sigma = 0.03;    // of each finger's closure when a posture is repeated
  double approach = 0.01;         // m, each coordinate of where the hand takes an object
  double approach_turn = 0.1745;  // rad, largest turn of the same
};

/// How far each finger is closed, 0 to 1.
using Closure = std::array<double, model::finger_count>;

/// A hand that has closed on an object.
struct HumanGrasp {
  Closure closure;
  Pose X_OG;  // where its grasp frame was
};

/// Which fingers take part in a grasp: in a precision grasp ring and little finger stay out of it.
std::array<bool, model::finger_count> fingers_of(GraspType type);

/// A synthetic person with four sensors on the hand, repeating postures and grasps as people do:
/// never twice the same. Everything follows from the seed.
class Demonstrator {
 public:
  Demonstrator(std::string user, std::uint64_t seed, const DemonstratorOptions& options);

  const std::string& user() const { return user_; }
  const model::HumanHand& hand() const { return hand_; }

  /// Takes the glove off and puts it on again: the sensors then sit elsewhere.
  void new_take();

  /// The same to the glove: the hand's scale as calibrated, and where the sensor on the back of the
  /// hand, which it takes for H, really sits.
  double calibrated_scale() const { return calibrated_scale_; }
  const Pose& X_HR() const { return X_HR_; }

  /// Holds what has nothing to do elsewhere, as far as joints can be turned: the thumb opposite the
  /// fingers, as around a large object, beside the palm, or anywhere between; if
  /// `spreading`, index and little finger more or less apart, which else says something.
  void rest(bool spreading = true);
  /// What the glove says of fingers closed so far: fingertips, and the features made of them.
  /// splay: index and little finger spread apart, from 0, as in the open hand, to 1, as far as they
  /// go. resting: from 0, all is where `closure` has it, to 1, an open hand is where it rests.
  Fingertips sense(const Closure& closure, double splay = 0, double resting = 0);
  Features read(const Closure& closure, double splay = 0, double resting = 0);
  /// A posture repeated as people do: never exactly.
  Closure repeat(const Closure& closure);
  /// How far the fingers close on an object until they touch it, with the grasp frame near X_OG.
  /// None when no attempt came to a place where the open hand does not already touch.
  std::optional<HumanGrasp> reach(const model::Shape& shape, const Pose& X_OG, GraspType type);

 private:
  std::string user_;
  DemonstratorOptions options_;
  Random random_;
  model::HumanHand hand_;
  double calibrated_scale_;
  Pose X_HR_ = Pose::Identity();  // where the back of the hand's sensor really sits
  std::array<Eigen::Vector3d, model::finger_count> p_FS_;   // sensors on the fingertips
  model::HumanPosture rest_ = model::HumanPosture::Zero();  // rad, beside the open posture
};

}  // namespace prehend::mapping
