#pragma once

#include <vector>

#include "common/base/random.hpp"
#include "services/glove/core/calibration/hand_fit.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// A synthetic person with a glove: hand, fingers and joints unlike the average, sensors that sit
/// up to 5 mm off the fingertips and crooked on the back of the hand.
struct Person {
  explicit Person(Random& random) : scale(random.uniform(0.8, 1.25)), hand(scale, fingers(random)) {
    for (Eigen::Vector3d& offset : sensor)
      offset = random.normal3(1).normalized() * random.uniform(0, 0.005);
    const Eigen::Vector3d axis = random.normal3(1).normalized();
    X_HR = make_pose(random.normal3(1).normalized() * random.uniform(0, 0.004),
                     Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0, 0.026), axis)));
  }

  static std::array<double, model::finger_count> fingers(Random& random) {
    std::array<double, model::finger_count> factors{};
    for (double& factor : factors) factor = std::clamp(1 + random.normal(0.04), 0.9, 1.1);
    return factors;
  }

  /// A pose as this person shows it.
  static model::HumanPosture shown(ShownPose pose, Random& random) {
    model::HumanPosture q = posture_of(pose);
    for (double& angle : q) angle += random.normal(0.08);
    if (pose != ShownPose::pinch) return model::HumanHand(1).clamp(q);
    return q;
  }

  /// What the tracker sees; X_TR is the sensor on the back of the hand.
  Frame frame(double time, const model::HumanPosture& q, const Pose& X_TR, double noise,
              Random& random) const {
    Frame result;
    result.sequence = static_cast<std::uint64_t>(time * 30);
    result.stamp = Time(seconds(time));
    result.readings.push_back({Site::back_of_hand, true, X_TR.translation() + random.normal3(noise),
                               Eigen::Quaterniond(X_TR.linear())});
    const auto tips = hand.fingertip_poses(q);
    constexpr std::array sites{Site::thumb, Site::index, Site::middle, Site::ring, Site::little};
    for (std::size_t f = 0; f < tips.size(); ++f) {
      if (three_fingers && (f == 2 || f == 3)) continue;
      const Pose X_TF = X_TR * X_HR.inverse() * tips[f];
      result.readings.push_back({sites[f], true, X_TF * sensor[f] + random.normal3(noise),
                                 Eigen::Quaterniond(X_TF.linear())});
    }
    return result;
  }

  double scale;
  model::HumanHand hand;
  std::array<Eigen::Vector3d, model::finger_count> sensor;  // p_FS
  Pose X_HR;
  bool three_fingers = true;  // the glove of [Thesis, 4.1]; otherwise all five
};

}  // namespace prehend::glove
