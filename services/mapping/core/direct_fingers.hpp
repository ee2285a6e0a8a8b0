#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/grasp_type.hpp"
#include "services/mapping/core/mapping_modes.hpp"
#include "services/mapping/core/posture.hpp"
#include "services/mapping/core/ramp.hpp"
#include "services/mapping/core/retargeting/retargeter.hpp"

namespace prehend::mapping {

/// The fingers' answer to a posture as if no object were known. Keeps a reference to the hand.
class DirectFingers {
 public:
  /// ramp: time in which the combined mode goes from joints to fingertips or back.
  DirectFingers(const model::HandModel& hand, Duration ramp) : hand_(hand), precision_(ramp) {}

  /// Fails, and leaves all as it was, when the hand does not allow the mode.
  Expected<void> use(FingerMode mode);

  /// DoF values, rad or m. joints: what the direct network answers. before, grasp: of the last
  /// command. Fails when a fingertip that the mode needs is missing.
  Expected<Eigen::VectorXd> answer(const Posture& posture, const Eigen::VectorXd& joints,
                                   const Eigen::VectorXd& before, GraspType grasp,
                                   Duration elapsed);

 private:
  const model::HandModel& hand_;
  FingerMode mode_ = FingerMode::joints;
  std::optional<Retargeter> retargeter_;
  Ramp precision_;  // of the combined mode: share of the fingertips' answer
};

}  // namespace prehend::mapping
