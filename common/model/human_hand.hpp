#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/named_values.hpp"
#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

enum class Finger { thumb, index, middle, ring, little };
inline constexpr int finger_count = 5;
inline constexpr auto finger_names = named_values<Finger>({{Finger::thumb, "thumb"},
                                                           {Finger::index, "index"},
                                                           {Finger::middle, "middle"},
                                                           {Finger::ring, "ring"},
                                                           {Finger::little, "little"}});
std::optional<Finger> finger_from_string(std::string_view name);
inline constexpr int human_dof_count = 20;

/// Joint angles of a human hand, rad: four a finger, index, middle, ring, little, thumb:
/// abduction, MCP, PIP, DIP (thumb: CMC rotation, CMC flexion, MCP, IP).
using HumanPosture = Eigen::Matrix<double, human_dof_count, 1>;

/// Kinematics of a right human hand of a given size (20 DoF).
/// Frame H: on the back of the hand, above the middle finger's metacarpal; x towards the fingers,
/// z out of the back of the hand, y towards the thumb.
class HumanHand {
 public:
  /// scale: length relative to an average adult hand, 0.7 to 1.4. fingers: length of each finger's
  /// bones relative to that of a hand of this scale, 0.7 to 1.4.
  explicit HumanHand(double scale,
                     const std::array<double, finger_count>& fingers = {1, 1, 1, 1, 1});

  double scale() const { return scale_; }
  /// Lengths of the three bones of a finger, from the palm to the tip, m.
  std::array<double, 3> bones(Finger finger) const;
  /// Where a finger begins, in H, m: its first joint.
  Eigen::Vector3d base(Finger finger) const;
  /// Frame of the last segment of every finger; its origin is the fingertip (pad side of the tip),
  /// x along the segment.
  std::array<Pose, finger_count> fingertip_poses(const HumanPosture& posture) const;
  /// The segments of all fingers, in H.
  std::vector<Capsule> segments(const HumanPosture& posture) const;
  /// Joint angles forced into the limits of a hand.
  HumanPosture clamp(const HumanPosture& posture) const;

  /// Grasp frame (see placement.hpp) in H.
  Pose X_HG() const;

  static HumanPosture open_posture();
  static HumanPosture fist_posture();
  /// Every finger on its own between open (0) and closed (1); values outside are clamped.
  static HumanPosture posture(const std::array<double, finger_count>& closure);

  /// Closes every finger from open until one of its segments touches the object (or it is closed).
  /// Returns the closure of each finger, for posture().
  std::array<double, finger_count> close_on(const Shape& shape, const Pose& X_HO) const;

 private:
  double scale_;
  std::array<double, finger_count> fingers_;
};

}  // namespace prehend::model
