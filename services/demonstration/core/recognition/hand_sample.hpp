#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/model/human_hand.hpp"
#include "common/model/shape.hpp"

namespace prehend::demonstration {

inline constexpr double unknown_number = std::numeric_limits<double>::quiet_NaN();

/// What a hand shows at a time. Numbers that nobody measured are NaN.
struct HandSample {
  double t = 0;  // s since the grasp began
  /// Index, middle, ring and little fingertip as seen from the thumb's, in W, m.
  std::array<Eigen::Vector3d, 4> p_thumb_tip_W{
      Eigen::Vector3d::Constant(unknown_number), Eigen::Vector3d::Constant(unknown_number),
      Eigen::Vector3d::Constant(unknown_number), Eigen::Vector3d::Constant(unknown_number)};
  /// Fingertips in H, as the sensor on the back of the hand sees them [Thesis, eq. 4.1], m; and the
  /// hand's length relative to an average one.
  std::array<Eigen::Vector3d, model::finger_count> p_HF = [] {
    std::array<Eigen::Vector3d, model::finger_count> made;
    made.fill(Eigen::Vector3d::Constant(unknown_number));
    return made;
  }();
  double scale = unknown_number;
  double hand_speed = unknown_number, wrist_speed = unknown_number;  // m/s
};

/// A grasp that somebody showed, and of what kind it was.
struct Take {
  std::string user, task, label, side, action;
  int trial = 0;
  std::vector<HandSample> samples;       // by time
  std::optional<model::Shape> object{};  // what was grasped, as it was measured
};

}  // namespace prehend::demonstration
