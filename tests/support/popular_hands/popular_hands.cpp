#include "tests/support/popular_hands/popular_hands.hpp"

#include <fmt/format.h>

#include <cmath>

namespace popular_hands {
namespace {

/// Bodies and joints of a URDF. Boxes: size and middle, m.
class Writer {
 public:
  explicit Writer(const std::string& name) { text_ = "<robot name=\"" + name + "\">\n"; }

  void link(const std::string& name, double mass, const std::string& size,
            const std::string& middle) {
    text_ += fmt::format(
        "  <link name=\"{0}\"><inertial><origin xyz=\"{3}\"/><mass value=\"{1}\"/><inertia "
        "ixx=\"{4}\" ixy=\"0\" ixz=\"0\" iyy=\"{4}\" iyz=\"0\" izz=\"{4}\"/></inertial>\n"
        "    <collision><origin xyz=\"{3}\"/><geometry><box size=\"{2}\"/></geometry></collision>"
        "</link>\n",
        name, mass, size, middle, mass * 2e-4);
  }

  void bare(const std::string& name) { text_ += "  <link name=\"" + name + "\"/>\n"; }

  void joint(const std::string& name, const std::string& parent, const std::string& child,
             const std::string& xyz, const std::string& rpy, const std::string& axis, double lower,
             double upper, const std::string& mimic = "") {
    text_ += fmt::format(
        "  <joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/><origin "
        "xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/><limit lower=\"{}\" upper=\"{}\" effort=\"{}\" "
        "velocity=\"{}\"/>{}</joint>\n",
        name, type, parent, child, xyz, rpy, axis, lower, upper, effort, velocity, mimic);
  }

  void fixed(const std::string& parent, const std::string& child, const std::string& xyz) {
    text_ += fmt::format(
        "  <joint name=\"{0}_{1}\" type=\"fixed\"><parent link=\"{0}\"/><child link=\"{1}\"/>"
        "<origin xyz=\"{2}\"/></joint>\n",
        parent, child, xyz);
  }

  std::string done() const { return text_ + "</robot>\n"; }

  std::string type = "revolute";
  double effort = 1, velocity = 3;

 private:
  std::string text_;
};

std::string follow(const std::string& joint, double multiplier) {
  return fmt::format("<mimic joint=\"{}\" multiplier=\"{}\"/>", joint, multiplier);
}

}  // namespace

// Fingers along z, out of the palm along x; dimensions of the Allegro hand.
std::string sixteen_joints_with_opposed_thumb() {
  Writer w("sixteen");
  w.effort = 10;
  w.link("palm", 0.4, "0.041 0.112 0.095", "-0.009 0 -0.047");
  const auto bend = [&](const std::string& f, int i, const std::string& xyz, double lower,
                        double upper) {
    w.joint(fmt::format("{}_{}", f, i), fmt::format("{}_link{}", f, i - 1),
            fmt::format("{}_link{}", f, i), xyz, "0 0 0", "0 1 0", lower, upper);
  };
  int finger = 0;
  for (const auto& [y, tilt] : {std::pair(0.0435, -0.087), {0.0, 0.0}, {-0.0435, 0.087}}) {
    const std::string f = fmt::format("finger{}", finger++);
    w.link(f + "_link0", 0.012, "0.02 0.027 0.016", "0 0 0.008");
    w.link(f + "_link1", 0.065, "0.02 0.027 0.054", "0 0 0.027");
    w.link(f + "_link2", 0.036, "0.02 0.027 0.038", "0 0 0.019");
    w.link(f + "_link3", 0.037, "0.02 0.025 0.05", "0 0 0.02");
    w.joint(f + "_0", "palm", f + "_link0", fmt::format("0 {} 0", y), fmt::format("{} 0 0", tilt),
            "0 0 1", -0.47, 0.47);
    bend(f, 1, "0 0 0.0164", -0.196, 1.61);
    bend(f, 2, "0 0 0.054", -0.174, 1.709);
    bend(f, 3, "0 0 0.0384", -0.227, 1.618);
  }
  w.link("thumb_link0", 0.018, "0.03 0.02 0.035", "-0.018 0.01 0.018");
  w.link("thumb_link1", 0.012, "0.02 0.027 0.016", "0 0 0.008");
  w.link("thumb_link2", 0.038, "0.02 0.027 0.05", "0 0 0.026");
  w.link("thumb_link3", 0.05, "0.02 0.025 0.062", "0 0 0.033");
  w.joint("thumb_0", "palm", "thumb_link0", "-0.0182 0.0193 -0.046", "0 -1.658 -1.5708", "-1 0 0",
          0.263, 1.396);
  w.joint("thumb_1", "thumb_link0", "thumb_link1", "-0.027 0.005 0.0399", "0 0 0", "0 0 1", -0.105,
          1.163);
  bend("thumb", 2, "0 0 0.0177", -0.189, 1.644);
  bend("thumb", 3, "0 0 0.0514", -0.162, 1.719);
  return w.done();
}

// Fingers along z, out of the palm along x. Each bends, then goes aside, then bends twice.
std::string sixteen_joints_with_side_joints() {
  Writer w("side");
  w.effort = 0.95;
  w.velocity = 0;
  w.link("palm", 0.3, "0.03 0.11 0.09", "-0.005 0 -0.045");
  const auto finger = [&](const std::string& f, const std::string& xyz, const std::string& rpy) {
    w.link(f + "_link0", 0.032, "0.022 0.022 0.022", "0 0 0.008");
    w.link(f + "_link1", 0.038, "0.022 0.024 0.036", "0 0 0.02");
    w.link(f + "_link2", 0.044, "0.022 0.024 0.034", "0 0 0.018");
    w.link(f + "_link3", 0.025, "0.02 0.022 0.046", "0 0 0.024");
    w.joint(f + "_0", "palm", f + "_link0", xyz, rpy, "0 1 0", -0.3, 2.0);
    w.joint(f + "_1", f + "_link0", f + "_link1", "0 0 0.015", "0 0 0", "1 0 0", -1.0, 1.0);
    w.joint(f + "_2", f + "_link1", f + "_link2", "0 0 0.037", "0 0 0", "0 1 0", -0.5, 1.9);
    w.joint(f + "_3", f + "_link2", f + "_link3", "0 0 0.036", "0 0 0", "0 1 0", -0.4, 2.0);
  };
  finger("index", "0 0.044 0", "0 0 0");
  finger("middle", "0 0 0", "0 0 0");
  finger("ring", "0 -0.044 0", "0 0 0");
  // Beside the palm, below the index finger, and looks out of it; it turns about its own length.
  w.link("thumb_link0", 0.032, "0.022 0.022 0.022", "0 0 0.008");
  w.link("thumb_link1", 0.038, "0.022 0.024 0.036", "0 0 0.02");
  w.link("thumb_link2", 0.044, "0.022 0.024 0.034", "0 0 0.018");
  w.link("thumb_link3", 0.025, "0.02 0.022 0.046", "0 0 0.024");
  w.joint("thumb_0", "palm", "thumb_link0", "0 0.035 -0.075", "0 1.2 0", "1 0 0", -0.5, 1.5);
  w.joint("thumb_1", "thumb_link0", "thumb_link1", "0 0 0.015", "0 0 0", "0 0 1", -1.6, 1.6);
  w.joint("thumb_2", "thumb_link1", "thumb_link2", "0 0 0.037", "0 0 0", "0 -1 0", -0.5, 1.9);
  w.joint("thumb_3", "thumb_link2", "thumb_link3", "0 0 0.036", "0 0 0", "0 -1 0", -0.4, 2.0);
  return w.done();
}

// Fingers along z, out of the palm along -y, as the Shadow hand.
std::string five_fingers_with_wrist() {
  Writer w("wristed");
  w.effort = 2;
  w.velocity = 2;
  w.bare("world");
  w.link("forearm", 3, "0.11 0.11 0.2", "0 0 0.1");
  w.link("wrist", 0.1, "0.04 0.03 0.04", "0 0 0.01");
  w.link("palm", 0.3, "0.075 0.022 0.085", "0 0 0.042");
  w.fixed("world", "forearm", "0 0 0");
  w.joint("wrist_2", "forearm", "wrist", "0 -0.01 0.213", "0 0 0", "0 1 0", -0.52, 0.17);
  w.joint("wrist_1", "wrist", "palm", "0 0 0.034", "0 0 0", "1 0 0", -0.7, 0.49);
  const auto finger = [&](const std::string& f, const std::string& carrier, const std::string& xyz,
                          double side, double effort) {
    w.effort = effort;
    w.link(f + "_knuckle", 0.008, "0.012 0.012 0.012", "0 0 0");
    w.link(f + "_proximal", 0.03, "0.016 0.016 0.04", "0 0 0.024");
    w.link(f + "_middle", 0.017, "0.015 0.015 0.022", "0 0 0.0125");
    w.link(f + "_distal", 0.012, "0.015 0.014 0.028", "0 0 0.014");
    w.joint(f + "_4", carrier, f + "_knuckle", xyz, "0 0 0", fmt::format("0 {} 0", side), -0.35,
            0.35);
    w.joint(f + "_3", f + "_knuckle", f + "_proximal", "0 0 0", "0 0 0", "1 0 0", -0.26, 1.57);
    w.joint(f + "_2", f + "_proximal", f + "_middle", "0 0 0.045", "0 0 0", "1 0 0", 0, 1.57);
    w.joint(f + "_1", f + "_middle", f + "_distal", "0 0 0.025", "0 0 0", "1 0 0", 0, 1.57,
            follow(f + "_2", 1));
  };
  finger("first", "palm", "0.033 0 0.095", -1, 2);
  finger("middle", "palm", "0.011 0 0.099", -1, 2);
  finger("ring", "palm", "-0.011 0 0.095", 1, 2);
  w.link("metacarpal", 0.03, "0.02 0.018 0.05", "0.004 0 0.03");
  w.joint("little_5", "palm", "metacarpal", "-0.037 0 0.021", "0 0 0", "0.57 0 0.82", 0, 0.785);
  finger("little", "metacarpal", "0.004 0 0.066", 1, 2);
  w.link("thumb_base", 0.01, "0.012 0.012 0.012", "0 0 0");
  w.link("thumb_proximal", 0.04, "0.022 0.022 0.03", "0 0 0.019");
  w.link("thumb_hub", 0.005, "0.012 0.012 0.012", "0 0 0");
  w.link("thumb_middle", 0.02, "0.02 0.02 0.028", "0 0 0.016");
  w.link("thumb_distal", 0.016, "0.018 0.018 0.03", "0 0 0.015");
  w.joint("thumb_5", "palm", "thumb_base", "0.034 -0.0086 0.029", "-0.7854 0 -1.5708", "0 0 -1",
          -1.047, 1.047);
  w.joint("thumb_4", "thumb_base", "thumb_proximal", "0 0 0", "0 0 0", "0 1 0", 0, 1.22);
  w.joint("thumb_3", "thumb_proximal", "thumb_hub", "0 0 0.038", "0 0 0", "0 1 0", -0.21, 0.21);
  w.joint("thumb_2", "thumb_hub", "thumb_middle", "0 0 0", "0 0 0", "1 0 0", -0.7, 0.7);
  w.joint("thumb_1", "thumb_middle", "thumb_distal", "0 0 0.032", "0 0 0", "1 0 0", -0.26, 1.57);
  return w.done();
}

// Fingers along z, out of the palm along x; the thumb beside the palm on the side of the index.
std::string six_motors(bool left) {
  Writer w("six");
  w.effort = 10;
  w.velocity = 0.5;
  const double side = left ? -1 : 1;
  w.link("flange", 0.2, "0.05 0.05 0.03", "0 0 -0.1");
  w.link("palm", 0.35, "0.026 0.084 0.085", "0 0 -0.042");
  w.fixed("flange", "palm", "0 0 0");
  int number = 0;
  for (const char* name : {"index", "middle", "ring", "little"}) {
    const std::string f = name;
    const double y = side * (0.031 - 0.0205 * number), shorter = f == "little" ? 0.008 : 0;
    ++number;
    w.link(f + "_1", 0.03, fmt::format("0.014 0.015 {}", 0.036 - shorter),
           fmt::format("0 0 {}", 0.018 - shorter / 2));
    w.link(f + "_2", 0.02, fmt::format("0.013 0.014 {}", 0.05 - shorter),
           fmt::format("0 0 {}", 0.024 - shorter / 2));
    w.joint(f, "palm", f + "_1", fmt::format("0 {} 0.004", y), "0 0 0", "0 1 0", 0, 1.47);
    w.joint(f + "_end", f + "_1", f + "_2", fmt::format("0 0 {}", 0.036 - shorter), "0 0 0",
            "0 1 0", 0, 1.6, follow(f, 1.08));
  }
  w.link("thumb_0", 0.01, "0.016 0.016 0.016", "0 0 0");
  w.link("thumb_1", 0.03, "0.018 0.018 0.04", "0 0 0.024");
  w.link("thumb_2", 0.02, "0.016 0.016 0.022", "0 0 0.012");
  w.link("thumb_3", 0.02, "0.015 0.015 0.026", "0 0 0.013");
  // At 0 the thumb lies in the palm's plane, aside; at 1.3 it stands against the fingers.
  w.joint("thumb_yaw", "palm", "thumb_0", fmt::format("0.012 {} -0.06", side * 0.034),
          fmt::format("{} 0 0", -side), fmt::format("0 0.841 {}", -0.54 * side), 0, 1.3);
  w.joint("thumb_bend", "thumb_0", "thumb_1", "0 0 0", "0 0 0", fmt::format("{} 0 0", side), 0,
          0.7);
  w.joint("thumb_middle", "thumb_1", "thumb_2", "0 0 0.046", "0 0 0", fmt::format("{} 0 0", side),
          0, 1, follow("thumb_bend", 1.3));
  w.joint("thumb_end", "thumb_2", "thumb_3", "0 0 0.023", "0 0 0", fmt::format("{} 0 0", side), 0,
          1, follow("thumb_bend", 0.8));
  return w.done();
}

// Two fingers against one, out of the palm along z.
std::string three_adaptive_fingers() {
  Writer w("adaptive");
  w.effort = 60;
  w.velocity = 1;
  w.link("palm", 1, "0.12 0.1 0.06", "0 0 -0.03");
  const auto finger = [&](const std::string& f, const std::string& xyz, const std::string& rpy) {
    w.link(f + "_1", 0.12, "0.022 0.02 0.057", "0 0 0.0285");
    w.link(f + "_2", 0.08, "0.022 0.018 0.038", "0 0 0.019");
    w.link(f + "_3", 0.06, "0.022 0.016 0.036", "0 0 0.018");
    w.joint(f, "palm", f + "_1", xyz, rpy, "-1 0 0", 0, 1.2);
    w.joint(f + "_middle", f + "_1", f + "_2", "0 0 0.057", "0 0 0", "-1 0 0", 0, 1.4,
            follow(f, 0.6));
    w.joint(f + "_end", f + "_2", f + "_3", "0 0 0.039", "0 0 0", "-1 0 0", -0.6, 1,
            follow(f, 0.3));
  };
  finger("left", "0.035 -0.045 0", "0.35 0 0");
  finger("right", "-0.035 -0.045 0", "0.35 0 0");
  finger("thumb", "0 0.045 0", "0.35 0 3.14159");
  return w.done();
}

std::string two_sliding_fingers() {
  Writer w("slides");
  w.type = "prismatic";
  w.effort = 20;
  w.velocity = 0.2;
  w.link("hand", 0.7, "0.04 0.2 0.066", "0 0 0.033");
  for (const auto& [name, sign] : {std::pair("left", 1), {"right", -1}}) {
    const std::string f = name;
    w.link(f, 0.1, "0.02 0.015 0.054", fmt::format("0 {} 0.027", 0.0075 * sign));
    w.joint(f + "_slide", "hand", f, "0 0 0.066", "0 0 0", fmt::format("0 {} 0", sign), 0, 0.04,
            sign < 0 ? "<mimic joint=\"left_slide\"/>" : "");
  }
  return w.done();
}

// The jaws stay parallel while their arms swing; their tips go away from the flange meanwhile, and
// an inner bar swings beside each arm.
std::string two_jaws_on_linkages() {
  Writer w("linkages");
  w.effort = 50;
  w.velocity = 0.5;
  w.link("base", 0.9, "0.075 0.14 0.09", "0 0 0.045");
  for (const auto& [name, sign] : {std::pair("left", 1), {"right", -1}}) {
    const std::string side = name, tilt = fmt::format("{} 0 0", -0.7 * sign),
                      back = fmt::format("{} 0 0", 0.7 * sign);
    const double low = sign > 0 ? 0 : -0.9, high = sign > 0 ? 0.9 : 0;
    w.link(side + "_arm", 0.03, "0.015 0.01 0.05", "0 0 0.025");
    w.link(side + "_bar", 0.02, "0.01 0.008 0.045", "0 0 0.0225");
    w.link(side + "_pad", 0.03, "0.022 0.008 0.05", fmt::format("0 {} 0.02", -0.004 * sign));
    w.joint(side + "_arm", "base", side + "_arm", fmt::format("0 {} 0.09", 0.03 * sign), tilt,
            "1 0 0", low, high, sign < 0 ? follow("left_arm", -1) : "");
    w.joint(side + "_bar", "base", side + "_bar", fmt::format("0 {} 0.1", 0.015 * sign), tilt,
            "1 0 0", low, high, follow("left_arm", sign));
    w.joint(side + "_pad", side + "_arm", side + "_pad", "0 0 0.055", back, "1 0 0", -high, -low,
            follow("left_arm", -sign));
  }
  return w.done();
}

std::string two_turning_jaws() {
  Writer w("jaws");
  w.effort = 2;
  w.link("base", 0.8, "0.06 0.1 0.06", "0 0 0.03");
  for (const auto& [name, sign] : {std::pair("left", 1), {"right", -1}}) {
    const std::string side = name;
    w.link(side, 0.05, "0.02 0.012 0.09", "0 0 0.045");
    w.joint(side + "_turn", "base", side, fmt::format("0 {} 0.06", 0.02 * sign),
            fmt::format("{} 0 0", -0.5 * sign), "1 0 0", sign > 0 ? 0 : -0.8, sign > 0 ? 0.8 : 0);
  }
  return w.done();
}

// Fingers that rest upright, and open further than they rest.
std::string three_fingers_around() {
  Writer w("around");
  w.link("palm", 0.5, "0.08 0.08 0.05", "0 0 0.025");
  for (const double angle : {0.0, 2.0944, 4.1888}) {
    const std::string f = fmt::format("finger{:.0f}", angle);
    for (const auto& [part, length] : {std::pair(1, 0.055), {2, 0.045}, {3, 0.03}})
      w.link(fmt::format("{}_{}", f, part), 0.03, fmt::format("0.018 0.018 {}", 0.9 * length),
             fmt::format("0 0 {}", 0.45 * length));
    w.joint(f, "palm", f + "_1",
            fmt::format("{} {} 0.05", 0.045 * std::cos(angle), 0.045 * std::sin(angle)),
            fmt::format("0 0 {}", angle + 3.14159), "0 1 0", -0.3, 1.4);
    w.joint(f + "_middle", f + "_1", f + "_2", "0 0 0.055", "0 0 0", "0 1 0", -0.3, 1.4,
            follow(f, 1));
    w.joint(f + "_end", f + "_2", f + "_3", "0 0 0.045", "0 0 0", "0 1 0", -0.3, 1.4,
            follow(f, 0.6));
  }
  return w.done();
}

std::vector<PopularHand> popular_hands() {
  return {{"opposed_thumb", sixteen_joints_with_opposed_thumb()},
          {"side_joints", sixteen_joints_with_side_joints()},
          {"wrist", five_fingers_with_wrist()},
          {"six_motors", six_motors(false)},
          {"six_motors_left", six_motors(true)},
          {"adaptive", three_adaptive_fingers()},
          {"slides", two_sliding_fingers()},
          {"linkages", two_jaws_on_linkages()},
          {"jaws", two_turning_jaws()},
          {"around", three_fingers_around()}};
}

}  // namespace popular_hands
