#include "tests/support/mjcf/mjcf_text.hpp"

#include <fmt/format.h>

#include <numbers>

namespace prehend::test {
namespace {

using Eigen::Vector3d;
using planner::Robot;

constexpr double ref = 0.1;  // rad or m, of joints that have one

std::string text_of(const Vector3d& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

std::string text_of(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  return fmt::format("pos=\"{}\" quat=\"{} {} {} {}\"", text_of(Vector3d(X.translation())), q.w(),
                     q.x(), q.y(), q.z());
}

constexpr const char* gripper = R"(<mujoco model="gripper">
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <body name="palm" pos="0 0 .4" euler="180 0 0">
      <freejoint/>
      <inertial mass=".5" pos="0 0 .01" diaginertia="1e-3 2e-3 2e-3"/>
      <geom type="box" size=".03 .06 .02"/>
      <geom type="sphere" size=".1" contype="0" conaffinity="0"/>
      <body name="left" pos="0 .01 .02">
        <joint name="left" type="slide" axis="0 2 0" range="0 .04"/>
        <geom type="capsule" fromto="0 0 0 0 0 .06" size=".008" mass=".03"/>
      </body>
      <body name="right" pos="0 -.01 .02">
        <joint name="right" type="slide" axis="0 -1 0" range="0 .04"/>
        <geom type="box" size=".01 .005 .03" pos="0 0 .03"/>
      </body>
    </body>
    <body name="cube"><freejoint/><geom type="box" size=".02 .02 .02"/></body>
  </worldbody>
  <equality><joint joint1="left" joint2="right" polycoef="0.001 1 0 0 0"/></equality>
  <actuator><position joint="left" kp="500" forcerange="-30 40"/></actuator>
</mujoco>)";

constexpr const char* three_fingers = R"(<mujoco>
  <compiler meshdir="assets" autolimits="false"/>
  <option timestep="0.001"/>
  <default>
    <default class="hand">
      <joint axis="1 0 0" limited="true" range="0 90" damping=".1"/>
      <default class="seen"><geom type="mesh" contype="0" conaffinity="0" group="2"/></default>
      <default class="felt"><geom type="capsule" size=".008 .02" group="3"/></default>
      <default class="end"><joint range="0 60"/><position kp="2" ctrlrange="0 1"/></default>
    </default>
  </default>
  <asset><mesh name="shell" file="shell.stl" scale=".001 .001 .001"/><mesh file="tip.obj"/></asset>
  <worldbody>
    <body name="palm" childclass="hand">
      <geom class="seen" mesh="shell"/>
      <geom type="cylinder" size=".04 .01"/>
      <frame pos="0 .03 .01"><body name="a">
        <joint name="a0"/><geom class="felt" pos="0 0 .02"/>
        <body name="a1" pos="0 0 .05">
          <joint name="a1" class="end"/><geom class="felt"/><geom class="seen" mesh="tip"/>
        </body>
      </body></frame>
      <body name="b" pos=".03 -.03 .01">
        <joint name="b0"/><geom class="felt" pos="0 0 .02"/>
        <body name="b1" pos="0 0 .05"><joint name="b1" class="end"/><geom class="felt"/></body>
      </body>
      <body name="c" pos="-.03 -.03 .01">
        <joint name="swing" axis="0 0 1" range="-30 30"/><joint name="c0"/>
        <geom class="felt" pos="0 0 .02"/>
        <body name="c1" pos="0 0 .05"><joint name="c1" class="end" stiffness="1"/>
          <geom class="felt"/></body>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="pull"><joint joint="a0" coef=".5"/><joint joint="a1" coef=".25"/></fixed></tendon>
  <equality><joint joint1="b1" joint2="b0" polycoef="0 .5"/></equality>
  <actuator>
    <position name="a" tendon="pull" kp="8" ctrlrange="0 2"/>
    <motor name="b" joint="b0" gear="3" ctrlrange="-1 1"/>
    <position joint="c0" class="end"/><motor joint="swing"/>
  </actuator>
</mujoco>)";

/// A crank, a coupler and a rocker; the toe on the coupler is tied to the rocker. {0}: the side.
constexpr const char* linkage = R"(
      <body name="{0}" pos="0 {1} .015" euler="0 0 {2}">
        <body name="{0}_crank">
          <joint name="{0}_crank" class="crank"/><geom pos="0 0 .02"/>
          <body name="{0}_coupler" pos="0 0 .045">
            <joint name="{0}_coupler"/><geom pos="0 -.01 .03" size=".01 .004 .025"/>
            <body name="{0}_toe" pos="0 -.01 0">
              <joint name="{0}_toe" class="toe"/><geom pos="0 -.005 0" size=".008 .004 .004"/>
            </body>
          </body>
        </body>
        <body name="{0}_rocker" pos="0 -.02 0"><joint name="{0}_rocker"/><geom pos="0 0 .02"/></body>
      </body>)";

constexpr const char* linkages = R"(<mujoco model="linkages">
  <compiler angle="radian"/>
  <default>
    <joint axis="1 0 0"/>
    <default class="crank"><joint range="-.4 .5"/></default>
    <default class="toe"><joint range="-.6 0" stiffness=".05" springref="1"/></default>
    <geom type="box" size=".008 .004 .02"/>
  </default>
  <worldbody>
    <body name="palm">
      <geom size=".03 .05 .015"/>{}{}
    </body>
  </worldbody>
  <equality>
    <connect body1="left_toe" body2="left_rocker" anchor="0 -.01 0"/>
    <connect body1="right_toe" body2="right_rocker" anchor="0 -.01 0"/>
    <joint joint1="right_crank" joint2="left_crank"/>
  </equality>
  <actuator><position joint="left_crank" kp="20" ctrlrange="-.4 .5"/></actuator>
</mujoco>)";

class Writer {
 public:
  Writer(const Robot& robot, const MjcfStyle& style) : robot_(robot), style_(style) {
    X_LN_ = style.moved ? moved_by() : Pose::Identity();
  }

  std::string write() {
    out_ = fmt::format("<mujoco model=\"{}\">\n  <compiler angle=\"{}\"/>\n", robot_.name,
                       style_.degrees ? "degree" : "radian");
    if (style_.defaults)
      out_ +=
          "  <default><joint axis=\"0 0 1\"/><default class=\"finger\">"
          "<geom type=\"box\" contype=\"1\" group=\"3\"/>"
          "<default class=\"slides\"><joint type=\"slide\"/></default></default></default>\n";
    out_ += "  <worldbody>\n";
    for (const planner::RobotLink& link : robot_.links)
      if (is_root(link)) write_body(link, nullptr);
    out_ += "  </worldbody>\n  <equality>\n";
    for (const planner::RobotJoint& joint : robot_.joints)
      if (joint.mimic) write_equality(joint);
    out_ += "  </equality>\n  <actuator>\n";
    for (const planner::RobotJoint& joint : robot_.joints)
      if (joint.moves() && !joint.mimic && joint.limit)
        out_ += fmt::format("    <motor joint=\"{0}\" forcerange=\"-{1} {1}\"/>\n", joint.name,
                            joint.limit->effort);
    return out_ + "  </actuator>\n</mujoco>\n";
  }

 private:
  bool is_root(const planner::RobotLink& link) const {
    for (const planner::RobotJoint& joint : robot_.joints)
      if (joint.child == link.name) return false;
    return true;
  }

  double ref_of(const planner::RobotJoint& joint) const {
    return style_.moved && joint.moves() ? ref : 0;
  }

  /// Where a joint has moved its child to at its ref.
  Pose at_ref(const planner::RobotJoint& joint) const {
    if (ref_of(joint) == 0) return Pose::Identity();
    if (joint.slides()) return make_pose(ref * joint.axis_J.normalized());
    return make_pose(Vector3d::Zero(),
                     Eigen::Quaterniond(Eigen::AngleAxisd(ref, joint.axis_J.normalized())));
  }

  void write_body(const planner::RobotLink& link, const planner::RobotJoint* joint) {
    // Bodies with a joint are moved; what stands in them is seen from there.
    const bool moved = joint && joint->moves();
    const Pose X_LN = moved ? X_LN_ : Pose::Identity();
    const Pose X_PN =
        joint ? parent_offset_.inverse() * joint->X_PJ * at_ref(*joint) * X_LN : Pose::Identity();
    if (style_.defaults && joint)
      out_ += fmt::format("<frame {}><body name=\"{}\" childclass=\"finger\">\n", text_of(X_PN),
                          link.name);
    else
      out_ += fmt::format("<body name=\"{}\" {}>\n", link.name, text_of(X_PN));
    if (moved) write_joint(*joint, X_LN.inverse());
    write_content(link, X_LN.inverse());
    for (const planner::RobotJoint& each : robot_.joints)
      if (each.parent == link.name) {
        parent_offset_ = X_LN;
        write_body(*robot_.find_link(each.child), &each);
      }
    out_ += style_.defaults && joint ? "</body></frame>\n" : "</body>\n";
  }

  void write_joint(const planner::RobotJoint& joint, const Pose& X_NL) {
    const double unit = style_.degrees && !joint.slides() ? 180 / std::numbers::pi : 1;
    const std::string type = joint.slides() ? "slide" : "hinge";
    out_ += fmt::format("  <joint name=\"{}\" {} axis=\"{}\" pos=\"{}\" ref=\"{}\"", joint.name,
                        !style_.defaults ? "type=\"" + type + "\""
                        : joint.slides() ? "class=\"slides\""
                                         : "",
                        text_of(Vector3d(X_NL.linear() * joint.axis_J)),
                        text_of(Vector3d(X_NL.translation())), unit * ref_of(joint));
    if (joint.limit && joint.type != "continuous")
      out_ += fmt::format(" range=\"{} {}\"", unit * joint.limit->lower, unit * joint.limit->upper);
    out_ += "/>\n";
  }

  void write_content(const planner::RobotLink& link, const Pose& X_NL) {
    if (link.inertial) {
      const Pose X = X_NL * link.inertial->X_LI;
      const Eigen::Matrix3d i = X.linear() * link.inertial->inertia_I * X.linear().transpose();
      out_ +=
          fmt::format("  <inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>\n",
                      text_of(Vector3d(X.translation())), link.inertial->mass, i(0, 0), i(1, 1),
                      i(2, 2), i(0, 1), i(0, 2), i(1, 2));
    }
    for (const planner::Solid& solid : link.collision) write_geom(solid, X_NL);
  }

  void write_geom(const planner::Solid& solid, const Pose& X_NL) {
    const Vector3d& s = solid.shape.size;
    const std::string pose = text_of(Pose(X_NL * solid.X_LS));
    if (solid.shape.kind == model::ShapeKind::box)
      out_ +=
          fmt::format("  <geom type=\"box\" size=\"{}\" {}/>\n", text_of(Vector3d(0.5 * s)), pose);
    else if (solid.shape.kind == model::ShapeKind::cylinder)
      out_ +=
          fmt::format("  <geom type=\"cylinder\" size=\"{} {}\" {}/>\n", s.x(), 0.5 * s.z(), pose);
    else
      out_ += fmt::format("  <geom type=\"sphere\" size=\"{}\" {}/>\n", s.x(), pose);
  }

  void write_equality(const planner::RobotJoint& joint) {
    // y - y0 = a0 + a1 (x - x0), where both stand at their ref as written.
    const double m = joint.mimic->multiplier;
    const double a0 =
        joint.mimic->offset + m * ref_of(*robot_.find_joint(joint.mimic->joint)) - ref_of(joint);
    out_ += fmt::format("    <joint joint1=\"{}\" joint2=\"{}\" polycoef=\"{} {} 0 0 0\"/>\n",
                        joint.name, joint.mimic->joint, a0, m);
  }

  const Robot& robot_;
  const MjcfStyle style_;
  Pose X_LN_, parent_offset_ = Pose::Identity();
  std::string out_;
};

}  // namespace

Pose moved_by() {
  return make_pose(Vector3d(0.01, -0.02, 0.03),
                   Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())));
}

std::string mjcf_gripper() {
  return gripper;
}

std::string mjcf_three_fingers() {
  return three_fingers;
}

std::string mjcf_linkages() {
  return fmt::format(linkages, fmt::format(linkage, "left", ".03", "0"),
                     fmt::format(linkage, "right", "-.03", "3.141592653589793"));
}

std::string mjcf_of(const planner::Robot& robot, const MjcfStyle& style) {
  return Writer(robot, style).write();
}

}  // namespace prehend::test
