// MJCF becomes the robot that MuJoCo would make of it. Small hands whose numbers can be told by
// looking, in each way of saying them; and a chain whose poses are MuJoCo's formula: each joint in
// turn moves the body by T(p) Q(q - ref) T(-p), all seen from the body.
#include "services/planner/tools/hand_import/mjcf.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "services/planner/tools/hand_import/check.hpp"
#include "services/planner/tools/hand_import/make_hand.hpp"
#include "services/planner/tools/hand_import/tree.hpp"
#include "tests/support/mjcf/mjcf_text.hpp"

namespace {

using namespace prehend;
using Eigen::Vector3d;
using planner::Robot;

constexpr double pi = std::numbers::pi;

Robot read(const std::string& text, const planner::IncludeReader& includes = {}) {
  auto robot = planner::read_mjcf(text, includes);
  if (!robot) throw std::runtime_error(robot.error().message());
  return *robot;
}

Robot of_world(const std::string& bodies, const std::string& more = "") {
  return read("<mujoco model='m'>" + more + "<worldbody>" + bodies + "</worldbody></mujoco>");
}

std::string codes(const Robot& robot) {
  std::string all;
  for (const planner::UrdfFinding& finding : robot.findings)
    all += finding.code + " (" + finding.element + ": " + finding.what + ")\n";
  return all;
}

const planner::UrdfFinding* finding(const Robot& robot, const std::string& code) {
  for (const planner::UrdfFinding& each : robot.findings)
    if (each.code == code) return &each;
  return nullptr;
}

TEST(Mjcf, AGripperOfTwoSlides) {
  const Robot robot = read(test::mjcf_gripper());
  EXPECT_EQ(robot.name, "gripper");
  ASSERT_EQ(robot.links.size(), 3u) << codes(robot);
  const planner::RobotLink &palm = robot.links[0], &left = robot.links[1];
  EXPECT_EQ(palm.name, "palm");
  EXPECT_EQ(palm.inertial->mass, 0.5);
  EXPECT_EQ(palm.inertial->inertia_I(1, 1), 2e-3);
  ASSERT_EQ(palm.collision.size(), 1u);
  EXPECT_EQ(palm.collision[0].shape.size, Vector3d(0.06, 0.12, 0.04));
  EXPECT_EQ(palm.visual.size(), 1u);
  ASSERT_EQ(left.collision.size(), 3u);  // a bar with round ends
  EXPECT_NEAR(left.collision[0].shape.size.z(), 0.06, 1e-12);
  EXPECT_NEAR(left.collision[0].X_LS.translation().z(), 0.03, 1e-12);
  EXPECT_NEAR(left.inertial->mass, 0.03, 1e-12);
  EXPECT_NEAR(left.inertial->X_LI.translation().z(), 0.03, 1e-12);
  EXPECT_FALSE(robot.links[2].inertial);  // of its density: `add` estimates it
  ASSERT_EQ(robot.joints.size(), 2u);
  EXPECT_TRUE(robot.joints[0].slides());
  EXPECT_EQ(robot.joints[0].axis_J, Vector3d::UnitY());
  EXPECT_EQ(robot.joints[0].limit->upper, 0.04);
  EXPECT_EQ(robot.joints[0].limit->effort, 40);
  // The one with the motor leads, whichever way the equality is written.
  EXPECT_FALSE(robot.joints[0].mimic);
  ASSERT_TRUE(robot.joints[1].mimic);
  EXPECT_EQ(robot.joints[1].mimic->joint, "left");
  EXPECT_NEAR(robot.joints[1].mimic->offset, -0.001, 1e-12);
  EXPECT_EQ(finding(robot, "beside-the-hand")->element, "body cube");
  const auto none = [](const planner::Solid&) -> Expected<std::vector<Vector3d>> {
    return fail("is not there");
  };
  const auto hand = planner::make_hand(robot, "gripper", none);
  ASSERT_TRUE(hand) << hand.error().message();
  EXPECT_EQ(hand->model.fingertips().size(), 2u);
  EXPECT_TRUE(hand->opposed);
}

TEST(Mjcf, AHandOfThreeFingersWithClasses) {
  const Robot robot = read(test::mjcf_three_fingers());
  ASSERT_EQ(robot.joints.size(), 7u) << codes(robot);
  const auto joint = [&](const std::string& name) { return *robot.find_joint(name); };
  EXPECT_NEAR(joint("a0").limit->upper, pi / 2, 1e-12);
  EXPECT_NEAR(joint("a1").limit->upper, pi / 3, 1e-12);
  EXPECT_NEAR(joint("swing").limit->lower, -pi / 6, 1e-12);
  EXPECT_EQ(joint("swing").axis_J, Vector3d::UnitZ());
  EXPECT_EQ(joint("a0").axis_J, Vector3d::UnitX());
  EXPECT_EQ(Vector3d(joint("a0").X_PJ.translation()), Vector3d(0, 0.03, 0.01));  // by its frame
  EXPECT_EQ(joint("a1").mimic->joint, "a0");
  EXPECT_NEAR(joint("a1").mimic->multiplier, 0.5, 1e-12);
  EXPECT_EQ(joint("b1").mimic->joint, "b0");
  EXPECT_NEAR(joint("b1").mimic->multiplier, 0.5, 1e-12);
  EXPECT_NEAR(joint("a0").limit->effort, 0.5 * 8 * 2, 1e-12);
  EXPECT_NEAR(joint("b0").limit->effort, 3, 1e-12);
  EXPECT_NEAR(joint("c0").limit->effort, 2, 1e-12);
  // Two joints of one body: a link without mass between them.
  EXPECT_EQ(joint("swing").parent, "palm");
  EXPECT_EQ(joint("c0").parent, joint("swing").child);
  EXPECT_EQ(joint("c0").child, "c");
  EXPECT_FALSE(robot.find_link(joint("swing").child)->inertial);
  const planner::UrdfFinding* passive = finding(robot, "no-actuator");
  ASSERT_TRUE(passive);
  EXPECT_EQ(passive->element, "joint c1");
  EXPECT_NE(passive->what.find("spring"), std::string::npos);
  EXPECT_EQ(passive->line, 30);
  ASSERT_EQ(robot.links[0].visual.size(), 1u);
  EXPECT_EQ(robot.links[0].visual[0].mesh, "shell.stl");
  EXPECT_EQ(robot.links[0].visual[0].mesh_folder, "assets");
  EXPECT_EQ(robot.links[0].visual[0].scale, Vector3d::Constant(0.001));
  EXPECT_EQ(robot.find_link("a1")->visual[0].mesh, "tip.obj");
  EXPECT_EQ(robot.find_link("a1")->collision.size(), 3u);
  for (const planner::UrdfFinding& each : robot.findings)
    EXPECT_EQ(each.severity, planner::Severity::warning) << each.what;
}

TEST(Mjcf, SeveralJointsOfABodyMoveItInTurn) {
  const Robot robot = of_world(
      "<body name='base'><body name='arm' pos='.1 .2 .3' quat='.5 .5 .5 .5'>"
      "<joint name='x' axis='1 1 0' pos='.01 .02 .03' ref='20'/>"
      "<joint name='y' type='slide' axis='0 0 1' pos='.2 0 0' ref='.01'/>"
      "<joint name='z' axis='0 1 2' pos='0 -.01 .05'/>"
      "<body name='end' pos='0 0 .1'/></body></body>");
  ASSERT_EQ(robot.joints.size(), 4u) << codes(robot);
  const std::vector<double> q{0.4, 0.03, -1.1};
  const auto turn = [](const Vector3d& p, const Vector3d& axis, double angle) {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(angle, axis.normalized()));
    return Pose(make_pose(p) * make_pose(Vector3d::Zero(), R) * make_pose(Vector3d(-p)));
  };
  const Pose X_BE = make_pose(Vector3d(0.1, 0.2, 0.3), Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5)) *
                    turn({0.01, 0.02, 0.03}, {1, 1, 0}, q[0] - 20 * pi / 180) *
                    make_pose(Vector3d(0, 0, q[1] - 0.01)) *
                    turn({0, -0.01, 0.05}, {0, 1, 2}, q[2]) * make_pose(Vector3d(0, 0, 0.1));
  const auto X = planner::Tree(robot).poses("base", {q[0], q[1], q[2], 0});
  EXPECT_LT((X.at("end").matrix() - X_BE.matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Mjcf, OrientationsInEachWay) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(0.3, Vector3d::UnitX()) * Eigen::AngleAxisd(-0.5, Vector3d::UnitY()) *
       Eigen::AngleAxisd(1.2, Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Quaterniond q(R);
  const Eigen::AngleAxisd a(R);
  const auto n = [](const Vector3d& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); };
  const std::pair<std::string, std::string> ways[] = {
      {"", "euler='0.3 -0.5 1.2'"},
      {"eulerseq='XYZ'", "euler='0.3 -0.5 1.2'"},
      {"", fmt::format("quat='{} {} {} {}'", 2 * q.w(), 2 * q.x(), 2 * q.y(), 2 * q.z())},
      {"", fmt::format("axisangle='{} {}'", n(2 * a.axis()), a.angle())},
      {"", fmt::format("xyaxes='{} {}'", n(R.col(0)), n(R.col(1) + 0.3 * R.col(0)))},
      {"", fmt::format("zaxis='{}'", n(R.col(2)))}};
  for (const auto& [compiler, way] : ways) {
    const Robot robot = of_world("<body name='a'><body name='b' " + way + "><joint/></body></body>",
                                 "<compiler angle='radian' " + compiler + "/>");
    ASSERT_EQ(robot.joints.size(), 1u) << codes(robot);
    const Eigen::Matrix3d found = robot.joints[0].X_PJ.linear();
    if (way.starts_with("zaxis")) {
      EXPECT_LT((found.col(2) - R.col(2)).norm(), 1e-9);  // nothing else is said of it
    } else if (compiler.empty()) {
      EXPECT_LT((found - R).norm(), 1e-9) << way;
    } else {
      // About axes that stand still: the last turn is the outermost.
      const Eigen::Matrix3d fixed =
          (Eigen::AngleAxisd(1.2, Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.5, Vector3d::UnitY()) *
           Eigen::AngleAxisd(0.3, Vector3d::UnitX()))
              .toRotationMatrix();
      EXPECT_LT((found - fixed).norm(), 1e-9);
    }
  }
}

// Where contacts are off everywhere, or given pair by pair, groups and pairs tell.
TEST(Mjcf, WhatCollides) {
  const Robot groups = of_world(
      "<body name='a'><geom size='.01' group='2'/><geom size='.02' group='3'/>"
      "<body name='b'><joint/><geom size='.03' name='tip'/><geom size='.04'/></body></body>",
      "<default><geom contype='0' conaffinity='0'/></default>"
      "<contact><pair geom1='tip' geom2='other'/><exclude body1='a' body2='b'/></contact>");
  ASSERT_EQ(groups.links.size(), 2u);
  ASSERT_EQ(groups.links[0].collision.size(), 1u);
  EXPECT_EQ(groups.links[0].collision[0].shape.size.x(), 0.02);
  ASSERT_EQ(groups.links[1].collision.size(), 1u);
  EXPECT_EQ(groups.links[1].collision[0].shape.size.x(), 0.03);
  const Robot ellipsoid = of_world(
      "<body name='a'><geom type='ellipsoid' size='.01 .01 .03'/>"
      "<body name='b'><joint/></body></body>");
  EXPECT_TRUE(finding(ellipsoid, "ellipsoid"));
  EXPECT_NEAR(2 * model::half_extents(ellipsoid.links[0].collision[0].shape).maxCoeff(), 0.06,
              1e-3);
}

// Roots: the palm that fingers hang on is the world, or a body is led through it.
TEST(Mjcf, WhereTheHandHangs) {
  const Robot fingers = of_world(
      "<geom type='box' size='.05 .05 .01'/><body name='a'><joint name='a' range='0 9'/></body>"
      "<body name='b'><joint name='b' range='0 9'/></body>");
  ASSERT_EQ(fingers.links.size(), 3u);
  EXPECT_EQ(fingers.links[0].name, "world");
  EXPECT_EQ(fingers.links[0].collision.size(), 1u);
  EXPECT_EQ(fingers.joints[1].parent, "world");
  const Robot led = of_world(
      "<geom type='box' size='1 1 .01'/><body name='a'><joint type='slide' range='0 1'/>"
      "<joint range='0 90'/><body name='b'><joint range='0 9'/></body></body>");
  EXPECT_EQ(led.joints[0].parent, "world");
  EXPECT_TRUE(led.links[0].collision.empty());
  EXPECT_EQ(led.joints[1].child, "a");
}

TEST(Mjcf, Includes) {
  const auto files = [](const std::string& name) -> Expected<std::string> {
    if (name == "f.xml")
      return std::string(
          "<mujocoinclude>\n<body name='f'><joint name='j' type='ball'/>"
          "<geom size='x'/></body></mujocoinclude>");
    if (name == "loop.xml") return std::string("<mujoco><include file='loop.xml'/></mujoco>");
    return fail("is not there");
  };
  const Robot robot =
      read("<mujoco><worldbody><body name='p'><include file='f.xml'/></body></worldbody></mujoco>",
           files);
  ASSERT_EQ(robot.links.size(), 2u) << codes(robot);
  EXPECT_EQ(robot.joints[0].type, "ball");  // which check() refuses
  ASSERT_TRUE(finding(robot, "bad-number"));
  EXPECT_EQ(finding(robot, "bad-number")->element, "link f in f.xml");
  EXPECT_EQ(finding(robot, "bad-number")->line, 2);
  for (const std::string file : {"loop.xml", "gone.xml", ""})
    EXPECT_TRUE(
        finding(read("<mujoco><include file='" + file + "'/></mujoco>", files), "missing-include"))
        << file;
  const auto binary = planner::read_mjcf(std::string("<mujoco>\0</mujoco>", 18), files);
  ASSERT_FALSE(binary);
  EXPECT_EQ(binary.error().message(), "holds a zero byte (XML is text)");
}

struct Broken {
  const char* world;
  const char* more;
  const char* code;
  planner::Severity severity;
};

constexpr auto error = planner::Severity::error, warning = planner::Severity::warning;
constexpr const char* two =
    "<body name='a'><body name='b'><joint name='j'/></body><body name='c'><joint name='k'/></body>"
    "</body>";

const Broken broken_models[] = {
    {"<body name='a'><geom type='box' size='.1 .1'/></body>", "", "bad-size", error},
    {"<body name='a'><geom type='box' size='1 1 -1'/></body>", "", "bad-size", error},
    {"<body name='a'><geom type='capsule' size='1' contype='0' conaffinity='0'/></body>", "",
     "bad-size", warning},
    {"<body name='a'><geom type='hfield' size='1'/></body>", "", "unknown-geometry", error},
    {"<body name='a'><geom type='mesh' mesh='m'/></body>", "", "missing-mesh", error},
    {"<body name='a' pos='1 2'/>", "", "bad-number", error},
    {"<body name='a' pos='1 2 1e300'/>", "", "bad-number", error},
    {"<body name='a'><body name='b' quat='0 0 0 0'/></body>", "", "bad-number", error},
    {"<body name='a'><body name='b' xyaxes='1 0 0 2 0 0'/></body>", "", "bad-number", error},
    {two, "<compiler eulerseq='xy'/>", "bad-number", error},
    {two, "<compiler coordinate='global'/>", "global-coordinates", error},
    {"<body name='a'><body name='a'/></body>", "", "duplicate-name", error},
    {"<body name='a'><body name='b'><freejoint/></body></body>", "", "joint-type", error},
    {"<body name='a'><geom class='q' size='1'/></body>", "", "unknown-class", error},
    {two, "<default><default><geom/></default></default>", "no-name", error},
    {"<body name='a'><composite type='grid'/></body>", "", "not-read", error},
    {"<body name='a'><geom size='1' mass='-1'/></body>", "", "no-mass", error},
    {two, "<equality><joint joint1='j' joint2='x'/></equality>", "mimic-missing", error},
    {two, "<equality><joint joint2='j'/></equality>", "mimic-missing", error},
    {two, "<equality><joint joint1='j' joint2='k' polycoef='0 1e-7'/></equality>", "coupling",
     error},
    {two, "<equality><joint joint1='j' joint2='k' polycoef='0 1 2'/></equality>", "coupling",
     warning},
    {two, "<equality><tendon tendon1='a' tendon2='b'/></equality>", "coupling", warning},
    {two, "<equality><connect body1='b' body2='c' anchor='0 0 0'/></equality>", "linkage", warning},
    {two, "<actuator><motor joint='x'/></actuator>", "mimic-missing", warning},
    {two, "<actuator><motor joint='j'/></actuator>", "no-actuator", warning},
    {two, "<actuator><motor site='s'/></actuator>", "actuator", warning},
    {two, "<tendon><spatial name='t'/></tendon><actuator><motor tendon='t'/></actuator>",
     "actuator", warning},
    {two, "<asset><mesh name='m'/></asset>", "no-geometry", warning},
};

TEST(Mjcf, NamesWhatIsBroken) {
  for (const Broken& broken : broken_models) {
    const Robot robot = of_world(broken.world, broken.more);
    const planner::UrdfFinding* named = finding(robot, broken.code);
    ASSERT_TRUE(named) << broken.world << broken.more << " must give " << broken.code << ", not\n"
                       << codes(robot);
    EXPECT_EQ(named->severity, broken.severity) << broken.code;
    EXPECT_GT(named->line, 0) << broken.code;
    EXPECT_FALSE(named->repair.empty() || named->what.empty() || named->element.empty());
  }
}

TEST(Mjcf, RefusesWhatIsNone) {
  for (const std::string text : {"", "<robot/>", "<mujoco>", "<mujoco><worldbody></mujoco>"})
    EXPECT_FALSE(planner::read_mjcf(text)) << text;
  EXPECT_TRUE(planner::is_mjcf("<?xml version='1.0'?><!-- a --><mujoco/>"));
  EXPECT_FALSE(planner::is_mjcf("<robot><mujoco/></robot>"));
  const auto none = [](const planner::Solid&) -> Expected<std::vector<Vector3d>> {
    return fail("is not there");
  };
  EXPECT_FALSE(planner::is_usable(planner::check(read("<mujoco/>"), none)));
}

// A joint that an equality holds, and couplings that say the same twice.
TEST(Mjcf, CouplingsOfSeveralJoints) {
  const std::string hand =
      "<body name='p'><body name='a'><joint name='a' range='0 60'/><body name='b'><joint name='b'/>"
      "<body name='c'><joint name='c' ref='10'/></body></body></body>"
      "<body name='d'><joint name='d' range='0 9'/></body></body>";
  const Robot robot =
      of_world(hand,
               "<equality><joint joint1='a' joint2='b' polycoef='0 2'/>"
               "<joint joint1='c' joint2='b' polycoef='.1 -1'/><joint joint1='c' joint2='a'/>"
               "<joint joint1='d' polycoef='.05'/></equality>");
  EXPECT_FALSE(robot.find_joint("a")->mimic);
  const planner::RobotJoint &b = *robot.find_joint("b"), &c = *robot.find_joint("c");
  EXPECT_EQ(b.mimic->joint, "a");
  EXPECT_NEAR(b.mimic->multiplier, 0.5, 1e-12);
  // c - ref = 0.1 - b, b = a / 2
  EXPECT_EQ(c.mimic->joint, "a");
  EXPECT_NEAR(c.mimic->multiplier, -0.5, 1e-12);
  EXPECT_NEAR(c.mimic->offset, 0.1 + 10 * pi / 180, 1e-12);
  // What its leader leaves it.
  EXPECT_EQ(b.type, "revolute");
  EXPECT_NEAR(b.limit->upper, pi / 6, 1e-12);
  const planner::RobotJoint& held = *robot.find_joint("d");
  EXPECT_FALSE(held.moves());
  EXPECT_NEAR(angle_between(held.X_PJ.linear(), Eigen::Matrix3d::Identity()), 0.05, 1e-12);
}

}  // namespace
