#pragma once

#include <Eigen/Core>

#include "services/demonstration/core/recognition/hand_sample.hpp"

namespace prehend::demonstration {

/// What a recogniser looks at.
enum class Inputs {
  posture,  // the hand's shape, whatever way it points: where fingertips are to each other and on
            // it
  motion,   // which way it points and how fast it moves, whatever its shape
  both
};

/// Of one sample. Posture: the ten distances between fingertips, three signed lengths that tell a
/// posture from its mirror image, and, where the back of the hand is measured, each fingertip as
/// seen from it and how its finger is stretched, bent and spread, as in a hand of average size.
/// Motion: directions from the thumb to the fingers, the palm's
/// direction, logarithms of the speeds. NaN where the sample does not say.
Eigen::VectorXd features(const HandSample& sample, Inputs inputs);
/// Without unmeasured numbers: NaN is replaced by what came before.
class FeatureStream {
 public:
  explicit FeatureStream(Inputs inputs) : inputs_(inputs) {}
  const Eigen::VectorXd& add(const HandSample& sample);

 private:
  Inputs inputs_;
  Eigen::VectorXd last_;
};

/// What was seen of a grasp so far as one vector: the mean of the features, their change since the
/// grasp began, and with motion also how long it takes and the greatest speeds.
class Summary {
 public:
  explicit Summary(Inputs inputs) : inputs_(inputs), stream_(inputs) {}
  Eigen::VectorXd add(const HandSample& sample);

 private:
  Inputs inputs_;
  FeatureStream stream_;
  Eigen::VectorXd first_, sum_;
  Eigen::VectorXi counts_;
  double begin_ = 0;
  Eigen::Vector2d fastest_ = Eigen::Vector2d::Constant(unknown_number);
};

/// Length of features() and of a summary.
Eigen::Index feature_count(Inputs inputs);
Eigen::Index summary_count(Inputs inputs);

}  // namespace prehend::demonstration
