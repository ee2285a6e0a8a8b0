// Two fingers that lie across the palm towards each other. Each is a bar of 50 mm about an axis at
// its own side; bars that lie higher must open first, and two forks, each with one tine above and
// one below the other's, cannot open one after the other at all.
#include "common/grasping/blocking.hpp"

#include <gtest/gtest.h>

#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::VectorXd;

/// Tines of a finger: place along the axis (x) and height above the palm when it lies down, m.
using Tines = std::vector<std::pair<double, double>>;

std::string link(const std::string& name, const Tines& tines, double up) {
  std::string text =
      "<link name=\"" + name +
      "\"><inertial><origin xyz=\"0 0 0.025\"/><mass value=\"0.1\"/><inertia "
      "ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/></inertial>";
  for (const auto& [x, height] : tines)
    text += "<collision><origin xyz=\"" + std::to_string(x) + " " + std::to_string(up * height) +
            " 0.025\"/><geometry><box size=\"0.008 0.008 0.05\"/></geometry></collision>";
  return text + "</link>";
}

std::string joint(const std::string& name, double y, double axis) {
  return "<joint name=\"" + name +
         "_joint\" type=\"revolute\"><parent link=\"palm\"/><child link=\"" + name +
         "\"/><origin xyz=\"0 " + std::to_string(y) + " 0.02\"/><axis xyz=\"" +
         std::to_string(axis) +
         " 0 0\"/><limit lower=\"0\" upper=\"1.6\" effort=\"1\" velocity=\"2\"/></joint>";
}

model::HandModel two_fingers(const Tines& left, const Tines& right, const std::string& more = {}) {
  // Lying down, the left finger's -y and the right one's +y look up.
  const std::string urdf =
      "<robot name=\"two\"><link name=\"palm\"><inertial><mass value=\"1\"/><inertia ixx=\"1e-3\" "
      "ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" "
      "izz=\"1e-3\"/></inertial><collision><geometry><box "
      "size=\"0.06 0.08 0.01\"/></geometry></collision></link>" +
      link("left", left, -1) + link("right", right, 1) + joint("left", -0.03, -1) +
      joint("right", 0.03, 1) + "</robot>";
  const std::string toml = R"(name = "two"
[grasp_frame]
position = [0.0, 0.0, 0.05]
orientation = [1.0, 0.0, 0.0, 0.0]
[reach]
opening = 0.06
engage = 0.03
clearance = 0.03
half_width = 0.03
[[dof]]
name = "left"
joint = "left_joint"
closing = 1
[[dof]]
name = "right"
joint = "right_joint"
closing = 1
[[fingertip]]
name = "left"
link = "left"
position = [0.0, 0.0, 0.05]
[[fingertip]]
name = "right"
link = "right"
position = [0.0, 0.0, 0.05]
[materials]
default = "plastic"
[postures]
open = [0.0, 0.0]
)" + more;
  auto hand = model::HandModel::parse(urdf, toml);
  if (!hand) throw std::runtime_error(hand.error().message());
  return *hand;
}

const double flat = 1.5707963267948966;

TEST(Blocking, WhatLiesOnTopOpensFirst) {
  const auto hand = two_fingers({{0, 0.012}}, {{0, 0}});
  const auto found = find_blocking(hand, VectorXd::Constant(2, flat));
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_TRUE(found->touching.empty());  // 4 mm apart
  EXPECT_EQ(found->blocked, (std::vector<LinkPair>{{2, 1}}));
  EXPECT_EQ(found->order, (std::vector<int>{0, 1}));
  EXPECT_EQ(to_string(*found, hand), "left blocks right; open left, then right");

  const auto other = two_fingers({{0, 0}}, {{0, 0.012}});
  EXPECT_EQ(find_blocking(other, VectorXd::Constant(2, flat))->order, (std::vector<int>{1, 0}));
}

TEST(Blocking, InterlockedForksHaveNoOrder) {
  const auto hand = two_fingers({{-0.01, 0.012}, {0.01, 0}}, {{-0.01, 0}, {0.01, 0.012}});
  const auto found = find_blocking(hand, VectorXd::Constant(2, flat));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->blocked, (std::vector<LinkPair>{{1, 2}, {2, 1}}));
  EXPECT_FALSE(found->order);
  EXPECT_NE(to_string(*found, hand).find("no order"), std::string::npos);
}

TEST(Blocking, FingersThatTouchMayStillBeFree) {
  // Side by side, a tenth of a millimetre apart.
  const auto hand = two_fingers({{-0.00405, 0}}, {{0.00405, 0}});
  const auto found = find_blocking(hand, VectorXd::Constant(2, flat));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->touching, (std::vector<LinkPair>{{1, 2}}));
  EXPECT_TRUE(found->blocked.empty());
  EXPECT_EQ(found->order, (std::vector<int>{0, 1}));
  EXPECT_EQ(to_string(*found, hand), "");
}

TEST(Blocking, RefusesNonsense) {
  const auto hand = two_fingers({{0, 0}}, {{0, 0.012}});
  EXPECT_FALSE(find_blocking(hand, VectorXd::Zero(3)));
  EXPECT_FALSE(find_blocking(hand, VectorXd::Constant(2, std::nan(""))));
  std::string tips;
  for (int i = 3; i <= 11; ++i)
    tips += "[[fingertip]]\nname = \"" + std::to_string(i) +
            "\"\nlink = \"right\"\nposition = [0.0, 0.0, 0.05]\n";
  const auto eleven = two_fingers({{0, 0}}, {{0, 0.012}}, tips);
  EXPECT_EQ(find_blocking(eleven, VectorXd::Zero(2)).error().message(),
            "two: has more than ten fingers");
}

TEST(Blocking, AnOpenBarrettIsFree) {
  const model::HandModel& hand = test::hand("barrett");
  const auto found = find_blocking(hand, hand.joint_angles(hand.postures().at("open")));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->blocked.empty());
  EXPECT_EQ(found->order, (std::vector<int>{0, 1, 2}));
}

}  // namespace
