#pragma once

#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/named_values.hpp"

namespace prehend::mapping {

/// How fingers are answered where no object is known; with one, its network's answer is blended in.
enum class FingerMode { joints, cartesian, combined, retargeting };

/// The one table of them; the first is that of a lab that names none.
inline constexpr auto finger_modes = named_values<FingerMode>(
    {{FingerMode::joints, "joints", "the trained direct network: postures to postures"},
     {FingerMode::cartesian, "cartesian", "fingertips to fingertips by inverse kinematics"},
     {FingerMode::combined, "combined",
      "joints for power grasps, fingertips for precision grasps, and smoothly between"},
     {FingerMode::retargeting, "retargeting", "vectors to fingertips by optimisation"}});

/// What an operator may change while the mapping runs.
struct MappingModes {
  /// How fingers are answered where no object is known.
  FingerMode fingers = FingerMode::joints;
  /// Detections improve the posture of the fingers.
  bool intelligent = true;
  /// Detections correct where the hand goes.
  bool placement = true;

  bool operator==(const MappingModes&) const = default;
};

/// The modes after an order of one or more words: a name of finger_modes;
/// direct (whatever the object) or intelligent; placement or no-placement. What is not named stays.
/// Fails on other words, and on two that contradict each other.
Expected<MappingModes> changed(MappingModes modes, std::string_view order);

/// The same words for all of it.
std::string to_string(const MappingModes& modes);

}  // namespace prehend::mapping
