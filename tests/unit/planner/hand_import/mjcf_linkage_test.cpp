// Closed linkages of MJCF whose motion is known. A parallelogram: its rocker turns as its crank
// does and its coupler the other way. With one joint more, that a spring presses against its stop,
// as in adaptive grippers, it is the same linkage until something touches it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "services/planner/tools/hand_import/make_hand.hpp"
#include "services/planner/tools/hand_import/mjcf.hpp"
#include "services/planner/tools/hand_import/tree.hpp"
#include "tests/support/mjcf/mjcf_text.hpp"

namespace {

using namespace prehend;

/// Crank and rocker of 50 mm, 30 mm apart. `end`: what the coupler carries.
std::string linkage(const std::string& coupler, const std::string& equality,
                    const std::string& actuator) {
  return "<mujoco model='m'><compiler angle='radian'/><worldbody><body name='base'>"
         "<body name='crank'><joint name='crank' axis='1 0 0' range='-.2 .9'/>"
         "<geom type='box' size='.005 .005 .025' pos='0 0 .025'/>"
         "<body name='coupler' pos='0 0 .05'>" +
         coupler +
         "<geom type='box' size='.005 .015 .005' pos='0 .015 0'/></body></body>"
         "<body name='rocker' pos='0 .03 0'><joint name='rocker' axis='1 0 0'/>"
         "<geom type='box' size='.005 .005 .025' pos='0 0 .025'/>"
         "<site name='pin' pos='0 0 .05'/></body></body></worldbody><equality>" +
         equality + "</equality><actuator>" + actuator + "</actuator></mujoco>";
}

planner::Robot read(const std::string& text) {
  auto robot = planner::read_mjcf(text);
  if (!robot) throw std::runtime_error(robot.error().message());
  return *robot;
}

constexpr const char* turns = "<joint name='coupler' axis='1 0 0'/>";
constexpr const char* connect = "<connect body1='coupler' body2='rocker' anchor='0 .03 0'/>";
constexpr const char* motor = "<motor joint='crank' ctrlrange='-2 2'/>";

std::string what(const planner::Robot& robot, const std::string& code) {
  for (const planner::UrdfFinding& finding : robot.findings)
    if (finding.code == code) return finding.what;
  return "";
}

void expect_parallelogram(const planner::Robot& robot) {
  const planner::RobotJoint *coupler = robot.find_joint("coupler"),
                            *rocker = robot.find_joint("rocker");
  ASSERT_TRUE(coupler->mimic && rocker->mimic) << what(robot, "linkage");
  EXPECT_EQ(coupler->mimic->joint, "crank");
  EXPECT_NEAR(coupler->mimic->multiplier, -1, 1e-3);
  EXPECT_NEAR(rocker->mimic->multiplier, 1, 1e-3);
  EXPECT_NEAR(rocker->mimic->offset, 0, 1e-3);
  EXPECT_NE(what(robot, "linkage").find("follow"), std::string::npos);
  EXPECT_EQ(what(robot, "no-actuator"), "");
}

TEST(MjcfLinkage, AParallelogramFollowsItsCrank) {
  expect_parallelogram(read(linkage(turns, connect, motor)));
}

TEST(MjcfLinkage, HeldBySites) {
  const std::string coupler = std::string(turns) + "<site name='end' pos='0 .03 0'/>";
  expect_parallelogram(read(linkage(coupler, "<connect site1='end' site2='pin'/>", motor)));
}

// The coupler's end bends, too, but a spring holds it straight at its stop.
TEST(MjcfLinkage, ASpringPressesAJointAgainstItsStop) {
  const std::string text =
      linkage(std::string(turns) +
                  "<body name='end' pos='0 .015 0'><joint name='bend' axis='1 0 0' "
                  "range='-1 0' stiffness='.05' springref='2'/></body>",
              "<connect body1='end' body2='rocker' anchor='0 .015 0'/>", motor);
  const planner::Robot robot = read(text);
  expect_parallelogram(robot);
  EXPECT_FALSE(robot.find_joint("bend")->moves());
}

// One motor moves all of it; the pads of the couplers stay upright as they close.
TEST(MjcfLinkage, BecomesAGripper) {
  const planner::Robot robot = read(test::mjcf_linkages());
  const auto none = [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
    return fail("is not there");
  };
  const auto hand = planner::make_hand(robot, "linkages", none);
  ASSERT_TRUE(hand) << hand.error().message();
  ASSERT_EQ(hand->model.dofs().size(), 1u);
  EXPECT_EQ(hand->model.fingertips().size(), 2u);
  EXPECT_FALSE(robot.find_joint("left_toe")->moves());
  const planner::Tree tree(robot);
  for (const double crank : {-0.4, 0.0, 0.5}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const auto leader = planner::leader_of(robot, i);
      values.push_back(leader ? leader->multiplier * crank + leader->offset : 0);
      if (robot.joints[i].name == "left_crank") values.back() = crank;
    }
    const auto X = tree.poses("palm", values);
    for (const std::string side : {"left", "right"})
      EXPECT_GT(X.at(side + "_coupler").linear()(2, 2), 0.9999) << side << " at " << crank;
  }
}

// Without a motor nobody leads; a motor at each end of a loop that has no freedom left for both.
TEST(MjcfLinkage, WhatCannotBeClosedStaysOpen) {
  const planner::Robot idle = read(linkage(turns, connect, ""));
  EXPECT_NE(what(idle, "linkage").find("stays open"), std::string::npos);
  const planner::Robot torn =
      read(linkage(turns, connect, motor + std::string("<motor joint='rocker'/>")));
  EXPECT_NE(what(torn, "linkage").find("stays open"), std::string::npos);
  for (const planner::RobotJoint& joint : torn.joints) EXPECT_FALSE(joint.mimic);
  // The hand held in the world, and what is not there: no loops of links.
  for (const std::string other : {"<weld body1='base'/>", "<connect body1='base' body2='x'/>",
                                  "<connect site1='pin' site2='x'/>",
                                  "<connect active='false' body1='coupler' body2='rocker'/>"})
    EXPECT_EQ(what(read(linkage(turns, other, motor)), "linkage"), "") << other;
}

}  // namespace
