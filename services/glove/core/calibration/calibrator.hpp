#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/glove/core/calibration/hand_fit.hpp"
#include "services/glove/core/calibration/still.hpp"
#include "services/glove/core/calibration/user_calibration.hpp"
#include "services/glove/core/processor.hpp"

namespace prehend::glove {

/// A pose that was shown, and how still the hand was.
struct Shown {
  ShownPose pose = ShownPose::open;
  Fingertips tips;
  double wobble = 0;  // m
};

/// Asks a person for the poses one after the other and takes each when the hand keeps still in it.
/// Pure: frames in, with their own times; nothing but the core's rejects is lost.
class Calibrator {
 public:
  Calibrator();

  /// What is to be shown now; nothing when all has been.
  std::optional<ShownPose> asked() const;
  /// Returns the pose once it is taken.
  std::optional<Shown> see(const Frame& frame);
  /// Why the last frame did not complete a pose, in few words.
  const std::string& waiting_for() const { return waiting_for_; }
  /// The last one shall be shown again. False if there is none.
  bool redo();

  /// The calibration, once all has been shown.
  Expected<UserCalibration> result(const std::string& user) const;

 private:
  Processor processor_;
  StillTaker still_;
  std::vector<Shown> shown_;
  std::string waiting_for_ = "no frames yet";
};

}  // namespace prehend::glove
