#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/glove/core/frame.hpp"
#include "services/glove/core/gate.hpp"
#include "services/glove/core/one_euro.hpp"

namespace prehend::glove {

struct ProcessorOptions {
  Pose X_WT = Pose::Identity();  // tracker on the table
  model::HumanHand hand{1};      // of the wearer: where a fingertip can be, and is at given angles
  double stale = 0.3;            // s, age at which a frame says nothing about now
  double carry = 0.1;            // s, a finger at rest is carried over that much lost input
};

/// What became of a frame: perhaps a posture, and the reasons for what was not used.
struct Processed {
  std::optional<Posture> posture;
  std::vector<std::string_view> rejects;  // one a rejected reading or frame
};

/// Frames of raw sensor poses in, clean hands out. Extreme points, values that are not finite,
/// rotations without norm, identity poses of lost sensors and stale frames never come through.
///
/// Fingertips are the invariant features of their sensors (features.hpp), thus in H. A finger that
/// has no sensor but joint angles has its tip where the wearer's hand model says.
class Processor {
 public:
  explicit Processor(const ProcessorOptions& options);

  /// `now` is the lab's time, to judge the age of the frame by.
  Processed process(const Frame& frame, Time now);

 private:
  struct Finger {
    Finger();
    Eigen::Vector3d base = Eigen::Vector3d::Zero();  // p_HF where the finger begins, m
    double reach = 0;                                // m, of the tip from there
    PointGate gate;
    PointFilter filter;
    std::optional<Time> seen;
    Eigen::Vector3d p_HF = Eigen::Vector3d::Zero();
    double speed = 0;  // m/s, fading
  };

  /// X_TH, if this frame's reading of the back of the hand can be trusted.
  std::optional<Pose> back_of_hand(const Frame& frame, Processed& result);
  /// Where the sensor says that the fingertip is, in H, if that can be trusted.
  static std::optional<Eigen::Vector3d> sensed(const Reading& reading, const Pose& X_TH,
                                               Processed& result);
  /// The joint angles, if they can be trusted, forced into the limits of a hand.
  std::optional<model::HumanPosture> angles(const Frame& frame, Processed& result) const;
  /// Is the finger still nearly where it was seen last?
  bool can_be_carried(const Finger& finger, Time stamp) const;
  /// True if the finger takes this place.
  bool follow(Finger& finger, Time stamp, const Eigen::Vector3d& p_HF, Processed& result);

  ProcessorOptions options_;
  std::optional<Time> last_, before_;  // stamps of this frame and of the one before it
  PointGate hand_gate_;
  PointGate x_gate_, z_gate_;  // of the ends of two axes of H, so that rotations are gated too
  PointFilter hand_filter_;
  RotationFilter hand_rotation_;
  std::array<Finger, model::finger_count> fingers_;
};

}  // namespace prehend::glove
