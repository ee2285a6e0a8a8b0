#include "tests/unit/planner/hand_import/made_hands.hpp"

#include <fmt/format.h>

namespace made_hands {
namespace {

std::string link(const std::string& name, const std::string& content) {
  return fmt::format("  <link name=\"{}\">{}</link>\n", name, content);
}

std::string mass(double kg) {
  return fmt::format(
      "<inertial><origin xyz=\"0 0 0.02\"/><mass value=\"{0}\"/><inertia ixx=\"{1}\" ixy=\"0\" "
      "ixz=\"0\" iyy=\"{1}\" iyz=\"0\" izz=\"{1}\"/></inertial>",
      kg, kg * 2e-4);
}

std::string box(const std::string& element, double x, double y, double z, double height) {
  return fmt::format(
      "<{0}><origin xyz=\"0 0 {4}\"/><geometry><box size=\"{1} {2} {3}\"/></geometry></{0}>",
      element, x, y, z, height);
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& origin, const std::string& more) {
  return fmt::format(
      "  <joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/><origin "
      "{}/>{}</joint>\n",
      name, type, parent, child, origin, more);
}

}  // namespace

std::string gripper() {
  std::string text = "<robot name=\"gripper\">\n" + link("mount", "");
  text += link("body", mass(0.6) +
                           "<collision><geometry><mesh filename=\"package://made/palm.obj\" "
                           "scale=\"0.001 0.001 0.001\"/></geometry></collision>");
  text += joint("mount_body", "fixed", "mount", "body", "xyz=\"0 0 0.03\"", "");
  for (const auto& [side, sign] : {std::pair("left", 1), {"right", -1}}) {
    const std::string finger = std::string(side) + "_finger", pad = std::string(side) + "_pad";
    text += link(finger, mass(0.1) + box("collision", 0.02, 0.01, 0.05, 0.025));
    text += link(pad, box("collision", 0.02, 0.008, 0.03, 0.015));
    text += joint(finger + "_slide", "prismatic", "body", finger,
                  fmt::format("xyz=\"0 {} 0.02\"", 0.009 * sign),
                  fmt::format("<axis xyz=\"0 {} 0\"/><limit lower=\"0\" upper=\"0.04\" "
                              "effort=\"40\" velocity=\"0.1\"/>{}",
                              sign, sign < 0 ? "<mimic joint=\"left_finger_slide\"/>" : ""));
    text += joint(pad + "_screw", "fixed", finger, pad,
                  fmt::format("xyz=\"0 {} 0.03\"", -0.004 * sign), "");
  }
  return text + "</robot>\n";
}

std::string palm_mesh() {
  std::string text;
  for (const int x : {-30, 30})
    for (const int y : {-50, 50})
      for (const int z : {-20, 20}) text += fmt::format("v {} {} {}\n", x, y, z);
  return text + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
}

std::string four_fingers() {
  std::string text =
      "<robot name=\"four\">\n" + link("palm", mass(0.5) + box("collision", 0.08, 0.08, 0.03, 0));
  const auto finger = [&](const std::string& name, double x, double y, bool thumb) {
    const double width = 0.016;
    text += link(name + "_1", mass(0.05) + box("visual", width, width, 0.05, 0.025));
    text += link(name + "_2", mass(0.03) + box("collision", width, width, 0.04, 0.02));
    text += link(name + "_tip", "");
    // z of a finger leads away from the palm; all bend about x, the thumb the other way round.
    text += joint(name + "_base", thumb ? "continuous" : "revolute", "palm", name + "_1",
                  fmt::format("xyz=\"{} {} 0.02\" rpy=\"{} 0 0\"", x, y, thumb ? -0.5 : 0.5),
                  std::string(thumb ? "<axis xyz=\"1 0 0\"/>" : "<axis xyz=\"-1 0 0\"/>") +
                      (thumb ? ""
                             : "<limit lower=\"-0.1\" upper=\"1.4\" effort=\"0\" "
                               "velocity=\"0\"/>"));
    text +=
        joint(name + "_bend", "revolute", name + "_1", name + "_2", "xyz=\"0 0 0.055\"",
              fmt::format("<axis xyz=\"{} 0 0\"/><limit lower=\"0\" upper=\"1.4\" "
                          "effort=\"1\" velocity=\"3\"/>{}",
                          thumb ? 1 : -1,
                          thumb ? "" : "<mimic joint=\"" + name + "_base\" multiplier=\"0.8\"/>"));
    text += joint(name + "_end", "fixed", name + "_2", name + "_tip", "xyz=\"0 0 0.04\"", "");
  };
  finger("index", -0.028, -0.04, false);
  finger("middle", 0, -0.04, false);
  finger("ring", 0.028, -0.04, false);
  finger("thumb", 0, 0.04, true);
  return text + "</robot>\n";
}

}  // namespace made_hands
