#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/glove/core/calibration/calibrator.hpp"
#include "services/glove/core/joint_sensors.hpp"

namespace prehend::glove {

/// As Calibrator, for a glove that measures joints: from Frame::joint_counts come the gain and the
/// offset of each sensor. How long the hand is it cannot tell. Pure.
class JointCalibrator {
 public:
  JointCalibrator();

  /// What is to be shown now; nothing when all has been.
  std::optional<ShownPose> asked() const;
  /// Returns the pose once it is taken; its wobble is in counts.
  std::optional<Shown> see(const Frame& frame);
  const std::string& waiting_for() const { return waiting_for_; }
  bool redo();

  Expected<JointGains> result() const;

 private:
  StillTaker still_;
  std::vector<std::vector<double>> shown_;  // counts, one a pose
  std::string waiting_for_ = "no frames yet";
};

}  // namespace prehend::glove
