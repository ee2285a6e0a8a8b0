#pragma once

#include <string>
#include <vector>

/// Hands in the manner of today's popular ones, from their public dimensions, as URDF.
namespace popular_hands {

struct PopularHand {
  std::string name, urdf;
};

/// Four fingers of four joints, the thumb with a joint that opposes it; efforts of 10 N m as in the
/// published files.
std::string sixteen_joints_with_opposed_thumb();
/// Four fingers of four joints of which the second moves them aside; no velocities.
std::string sixteen_joints_with_side_joints();
/// Forearm, wrist, five fingers with coupled ends, thumb of five joints, arching palm; 24 joints.
std::string five_fingers_with_wrist();
/// Five fingers, six motors; all further joints follow by <mimic>; the thumb rests beside the palm.
/// left: mirrored.
std::string six_motors(bool left);
/// Three fingers of three joints each on one motor, that adapt.
std::string three_adaptive_fingers();
/// Two sliding fingers on a flange.
std::string two_sliding_fingers();

/// Two jaws on parallel linkages, one motor; all else follows by <mimic>.
std::string two_jaws_on_linkages();
/// Two jaws that turn, each with a motor.
std::string two_turning_jaws();
/// Three fingers of one motor each, at equal distances around a palm.
std::string three_fingers_around();

/// All of these.
std::vector<PopularHand> popular_hands();

}  // namespace popular_hands
