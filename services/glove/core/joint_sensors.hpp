#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/human_hand.hpp"

namespace prehend::glove {

/// A sensor of a glove that measures joints: CyberGlove-class, or one that bends with each finger.
struct JointSensor {
  std::string_view name;
  int dof;           // of model::HumanPosture; -1: none there (palm arch, wrist)
  bool of_eighteen;  // a glove with 18 sensors has it, too
  double gain;       // rad a count, typical
  double zero;       // counts where the joint is at 0, typical; only a calibration knows
};

/// The table of a user's file with their gains. Files have it so: it is no name of a device.
inline constexpr std::string_view joint_gains_table = "joint_glove";

/// The 22 sensors in the order in which they are sent; a glove with 18 leaves out those of the four
/// distal joints.
const std::vector<JointSensor>& joint_sensors();
inline constexpr std::size_t max_joint_sensors = 22, min_joint_sensors = 18;

/// One sensor a finger, thumb first: it bends with all joints of the finger by their sum, and is
/// calibrated as its middle joint (the thumb's last).
inline constexpr std::size_t finger_sensors = model::finger_count;

/// The sensors of a glove that has `count` of them; empty unless 5, 18 or 22.
std::vector<JointSensor> joint_sensors_of(std::size_t count);

/// angle = gain · counts + offset for every sensor, in the order in which they are sent; 5, 18
/// or 22. The table of this name in a user's calibration.
struct JointGains {
  std::vector<double> gain;    // rad a count
  std::vector<double> offset;  // rad
};

/// Typical gains, for somebody who has not been calibrated. Fails unless 5, 18 or 22.
Expected<JointGains> typical_gains(std::size_t count);

/// Sizes agree, 5, 18 or 22 of them, all finite, no gain zero.
Expected<void> check(const JointGains& gains);

/// Joint angles, rad, within the limits of a hand, from counts (of which there are as many as
/// gains). Of 18 a distal joint that is not measured bends 0.6 times as far as the one before it;
/// of 5 each finger is as far between open and fist as its sensor says.
model::HumanPosture joint_angles(const std::vector<double>& counts, const JointGains& gains);

/// How far each finger is closed, 0 open, 1 a fist, by five counts: not cut to that range.
std::array<double, model::finger_count> finger_closures(const std::vector<double>& counts,
                                                        const JointGains& gains);
/// The count of one of these fingers that is that far closed.
double finger_count_at(double closure, std::size_t finger, const JointGains& gains);

/// The counts that a glove would send, not rounded, from 1 to 255; what no joint moves is at 128.
std::vector<double> joint_counts(const model::HumanPosture& posture, const JointGains& gains);

/// Thumb and index fingertip of an average hand touch, the other fingers are half bent.
model::HumanPosture pinch_posture();

/// Gains and offsets of a person from counts while the hand is open (HumanHand::open_posture), a
/// fist (fist_posture) and pinches (of which only thumb and index count, as people do with the
/// others what they like): a line through these for each sensor, by least squares. A sensor that
/// hardly moved keeps its typical gain and is right at the open hand. Fails when there are no
/// samples, not all of the same length, or no finger moved.
Expected<JointGains> fit_gains(const std::vector<std::vector<double>>& open,
                               const std::vector<std::vector<double>>& fist,
                               const std::vector<std::vector<double>>& pinch);

}  // namespace prehend::glove
