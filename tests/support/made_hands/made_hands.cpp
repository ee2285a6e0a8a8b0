#include "tests/support/made_hands/made_hands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::test {
namespace {

using Motors = MadeHand::Motors;

constexpr double length = 0.09, apart = 0.025, across = 0.09;  // m, of fingers
constexpr double range = 1.6;                                  // rad, that a finger bends in all

/// Where a finger stands, and about which axis it bends inwards.
struct Finger {
  std::string name;
  double x, y;
  double axis_x, axis_y;
};

std::vector<Finger> fingers_of(const MadeHand& hand) {
  std::vector<Finger> fingers;
  const double side = hand.left ? -1 : 1;
  for (int f = 0; f < hand.fingers; ++f) {
    const std::string name = f == 0 && hand.thumb ? "thumb" : std::to_string(f);
    if (!hand.thumb) {
      const double turn = 2 * std::numbers::pi * f / hand.fingers;
      const double c = std::cos(turn), s = side * std::sin(turn);
      fingers.push_back({name, across / 2 * c, across / 2 * s, s, -c});
    } else if (f == 0) {
      fingers.push_back({name, across, side * 0.01, 0, -1});
    } else {
      fingers.push_back({name, 0, side * apart * (1 - f), 0, 1});
    }
  }
  if (hand.backwards) std::reverse(fingers.begin(), fingers.end());
  return fingers;
}

bool aside(const MadeHand& hand, int joint) {
  return hand.joints >= 4 && joint == 0;
}

std::string joint_name(const Finger& finger, int joint) {
  return fmt::format("{} {}", finger.name, joint);
}

/// The joint that this one follows; its own name where it has a motor.
std::string leader_of(const MadeHand& hand, const std::vector<Finger>& fingers,
                      const Finger& finger, int joint) {
  const int first = hand.joints >= 4 ? 1 : 0;
  if (aside(hand, joint) || hand.motors == Motors::of_joints) return joint_name(finger, joint);
  return joint_name(hand.motors == Motors::one ? fingers.front() : finger, first);
}

std::string urdf_of(const MadeHand& hand, const std::vector<Finger>& fingers) {
  const auto link = [](const std::string& name, double mass, const std::string& size, double z) {
    return fmt::format(
        "<link name=\"{}\"><inertial><origin xyz=\"0 0 {}\"/><mass value=\"{}\"/><inertia "
        "ixx=\"1e-5\" ixy=\"0\" ixz=\"0\" iyy=\"1e-5\" iyz=\"0\" izz=\"1e-5\"/></inertial>"
        "<collision><origin xyz=\"0 0 {}\"/><geometry><box size=\"{}\"/></geometry></collision>"
        "</link>\n",
        name, z, mass, z, size);
  };
  const double part = length / hand.joints;
  std::string text = "<robot name=\"made\">\n" + link("palm", 0.5, "0.1 0.1 0.02", -0.02);
  for (const Finger& finger : fingers)
    for (int j = 0; j < hand.joints; ++j) {
      const std::string name = joint_name(finger, j), leader = leader_of(hand, fingers, finger, j);
      const double bends = range / (hand.joints >= 4 ? hand.joints - 1 : hand.joints);
      text += link(name, 0.02, fmt::format("0.012 0.012 {}", part), part / 2);
      text += fmt::format(
          "<joint name=\"{0}\" type=\"revolute\"><parent link=\"{1}\"/><child link=\"{0}\"/>"
          "<origin xyz=\"{2} {3} {4}\"/><axis xyz=\"{5} {6} 0\"/><limit lower=\"{7}\" "
          "upper=\"{8}\" effort=\"1\" velocity=\"3\"/>{9}</joint>\n",
          name, j == 0 ? "palm" : joint_name(finger, j - 1), j == 0 ? finger.x : 0,
          j == 0 ? finger.y : 0, j == 0 ? 0 : part, aside(hand, j) ? finger.axis_y : finger.axis_x,
          aside(hand, j) ? -finger.axis_x : finger.axis_y, aside(hand, j) ? -0.3 : 0,
          aside(hand, j) ? 0.3 : bends,
          leader == name ? "" : fmt::format("<mimic joint=\"{}\" multiplier=\"1\"/>", leader));
    }
  return text + "</robot>\n";
}

std::string toml_of(const MadeHand& hand, const std::vector<Finger>& fingers) {
  std::string text = fmt::format(
      "name = \"{}\"\n[grasp_frame]\nposition = [{}, 0.0, 0.08]\n"
      "orientation = [1.0, 0.0, 0.0, 0.0]\n"
      "[reach]\nopening = 0.07\nengage = 0.03\nclearance = 0.02\nhalf_width = 0.04\n",
      hand.name(), hand.thumb ? across / 2 : 0.0);
  std::string open;
  for (const Finger& finger : fingers)
    for (int j = 0; j < hand.joints; ++j) {
      const std::string name = joint_name(finger, j);
      if (leader_of(hand, fingers, finger, j) != name) continue;
      text += fmt::format("[[dof]]\nname = \"{0}\"\njoint = \"{0}\"\nclosing = {1}\n", name,
                          aside(hand, j) ? 0 : 1);
      open += open.empty() ? "0.0" : ", 0.0";
    }
  for (const Finger& finger : fingers)
    text += fmt::format("[[fingertip]]\nname = \"{}\"\nlink = \"{}\"\nposition = [0.0, 0.0, {}]\n",
                        finger.name, joint_name(finger, hand.joints - 1), length / hand.joints);
  return text + "[materials]\ndefault = \"rubber\"\n[postures]\nopen = [" + open + "]\n";
}

}  // namespace

std::string MadeHand::name() const {
  return fmt::format("made of {} fingers, {} joints each, motors of {}{}{}{}", fingers, joints,
                     motors == Motors::of_joints    ? "joints"
                     : motors == Motors::of_fingers ? "fingers"
                                                    : "all",
                     thumb ? ", thumb" : "", left ? ", left" : "", backwards ? ", backwards" : "");
}

model::HandModel made_hand(const MadeHand& hand) {
  const auto fingers = fingers_of(hand);
  return model::HandModel::parse(urdf_of(hand, fingers), toml_of(hand, fingers)).value();
}

std::vector<MadeHand> made_hands() {
  std::vector<MadeHand> hands;
  for (int fingers = 2; fingers <= 5; ++fingers)
    for (int joints = 1; joints <= 5; ++joints)
      for (const Motors motors : {Motors::of_joints, Motors::of_fingers, Motors::one})
        for (const bool thumb : {true, false})
          for (const bool left : {false, true})
            hands.push_back({.fingers = fingers,
                             .joints = joints,
                             .motors = motors,
                             .thumb = thumb,
                             .left = left});
  return hands;
}

}  // namespace prehend::test
