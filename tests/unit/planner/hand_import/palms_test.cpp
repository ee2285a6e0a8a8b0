// Where a hand begins in the file of a whole robot: behind an arm, one of two, below a box that
// stands for the room. And what cannot move.
#include "services/planner/tools/hand_import/palms.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "services/planner/tools/hand_import/check.hpp"
#include "services/planner/tools/hand_import/make_hand.hpp"
#include "tests/unit/planner/hand_import/made_hands.hpp"

namespace {

using namespace prehend;
using planner::Robot;
using testing::ElementsAre;
using testing::IsEmpty;

Robot read(const std::string& urdf) {
  auto robot = planner::read_robot(urdf);
  if (!robot) throw std::runtime_error(robot.error().message());
  return std::move(*robot);
}

/// Four fingers, whose links and joints are named after the side.
std::string hand(const std::string& side) {
  std::string text = made_hands::four_fingers();
  text = text.substr(text.find('\n') + 1);
  text.resize(text.find("</robot>"));
  for (const char* attribute : {"name=\"", "link=\"", "joint=\""})
    for (std::size_t at = 0; (at = text.find(attribute, at)) != std::string::npos;) {
      at += std::string_view(attribute).size();
      text.insert(at, side);
    }
  return text;
}

/// So many joints, 15 cm apart, from `parent` to the palm of a side.
std::string arm(const std::string& side, const std::string& parent, double y, int joints) {
  std::string text, at = parent;
  for (int i = 0; i < joints; ++i) {
    const std::string next = i + 1 == joints ? side + "palm" : fmt::format("{}arm{}", side, i);
    if (i + 1 < joints)
      text += fmt::format(
          "<link name=\"{}\"><inertial><mass value=\"2\"/><inertia ixx=\"0.01\" iyy=\"0.01\" "
          "izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n",
          next);
    text += fmt::format(
        "<joint name=\"{}_joint{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/>"
        "<origin xyz=\"0 {} 0.15\"/><axis xyz=\"0 {} {}\"/><limit lower=\"-2\" upper=\"2\" "
        "effort=\"80\" velocity=\"1\"/></joint>\n",
        side, i, at, next, i == 0 ? y : 0.0, i % 2, 1 - i % 2);
    at = next;
  }
  return text;
}

std::string robot(const std::string& content) {
  return "<robot name=\"whole\">\n<link name=\"torso\"/>\n" + content + "</robot>\n";
}

std::vector<std::string> codes(const Robot& robot) {
  std::vector<std::string> all;
  for (const planner::UrdfFinding& finding : robot.findings) all.push_back(finding.code);
  return all;
}

TEST(Palms, OneHandIsTakenAsItIs) {
  const Robot bare = read(made_hands::four_fingers());
  EXPECT_THAT(planner::palms(bare), ElementsAre("palm"));
  const Robot taken = planner::hand_of(bare);
  EXPECT_EQ(taken.links.size(), bare.links.size());
  EXPECT_THAT(codes(taken), IsEmpty());
}

TEST(Palms, AWristStaysAndAnArmIsLeftOut) {
  const Robot wrist = planner::hand_of(read(robot(hand("") + arm("", "torso", 0, 2))));
  EXPECT_TRUE(wrist.find_link("torso"));
  const Robot behind_arm = planner::hand_of(read(robot(hand("") + arm("", "torso", 0, 6))));
  EXPECT_THAT(codes(behind_arm), ElementsAre("arm"));
  EXPECT_EQ(behind_arm.links.size(), read(made_hands::four_fingers()).links.size());
  EXPECT_FALSE(behind_arm.find_link("torso"));
  EXPECT_TRUE(planner::make_hand(behind_arm, "four", planner::mesh_files("."), {.samples = 20}));
}

TEST(Palms, OfTwoHandsOneIsChosen) {
  const std::string urdf =
      robot(hand("l_") + hand("r_") + arm("l_", "torso", 0.3, 6) + arm("r_", "torso", -0.3, 6));
  const Robot both = planner::hand_of(read(urdf));
  ASSERT_THAT(codes(both), ElementsAre("several-hands"));
  EXPECT_NE(both.findings[0].what.find("l_palm, r_palm"), std::string::npos);
  EXPECT_FALSE(planner::is_usable(planner::check(both, planner::mesh_files("."))));
  const Robot right = planner::hand_of(read(urdf), "r_palm");
  EXPECT_TRUE(right.find_link("r_thumb_1"));
  EXPECT_FALSE(right.find_link("l_thumb_1"));
  EXPECT_TRUE(planner::is_usable(planner::check(right, planner::mesh_files("."))));
  EXPECT_THAT(codes(planner::hand_of(read(urdf), "nobody")), ElementsAre("no-palm"));
}

TEST(Palms, TheRoomIsNoPartOfTheHand) {
  std::string urdf = robot(hand("") + arm("", "torso", 0, 1));
  urdf.replace(
      urdf.find("<link name=\"torso\"/>"), 20,
      "<link name=\"torso\"><inertial><mass value=\"500\"/></inertial><collision><geometry>"
      "<box size=\"3 3 0.1\"/></geometry></collision></link>");
  const Robot taken = planner::hand_of(read(urdf));
  EXPECT_THAT(codes(taken), ElementsAre("world"));
  EXPECT_TRUE(planner::is_usable(planner::check(taken, planner::mesh_files("."))));
}

// Told by a link at the tip that becomes part of another, or by one within the finger.
TEST(Fingers, FollowThoseOfAPersonWhereThatIsTold) {
  Robot robot = read(made_hands::four_fingers());
  robot.human = {{"index_tip", model::Finger::index}, {"thumb_1", model::Finger::thumb}};
  const auto hand = planner::make_hand(robot, "told", planner::mesh_files("."), {.samples = 20});
  ASSERT_TRUE(hand) << hand.error().message();
  int told = 0;
  for (const model::HandFingertip& tip : hand->model.fingertips()) {
    told += tip.human.has_value();
    if (tip.name.starts_with("index")) {
      EXPECT_EQ(tip.human, model::Finger::index);
    }
    if (tip.name.starts_with("thumb")) {
      EXPECT_EQ(tip.human, model::Finger::thumb);
    }
  }
  EXPECT_EQ(told, 2);
}

/// The same hand whose ring finger cannot move.
TEST(Locked, WhatCannotMoveAndWhatFollowsItIsHeldThere) {
  std::string urdf = made_hands::four_fingers();
  const std::size_t at = urdf.find("<limit", urdf.find("\"ring_base\""));
  urdf.replace(at, urdf.find("/>", at) - at,
               "<limit lower=\"0.3\" upper=\"0.3\" effort=\"1\" velocity=\"1\"");
  const auto hand =
      planner::make_hand(read(urdf), "locked", planner::mesh_files("."), {.samples = 20});
  ASSERT_TRUE(hand) << hand.error().message();
  EXPECT_EQ(hand->model.dofs().size(), 4u);  // two fingers, and the thumb's two
  // The finger became part of the palm, bent as it is locked: 0.3 rad, and 0.24 of what follows.
  const auto free = planner::make_hand(read(made_hands::four_fingers()), "free",
                                       planner::mesh_files("."), {.samples = 20});
  ASSERT_TRUE(free);
  EXPECT_EQ(hand->model.links().size() + 2, free->model.links().size());
}

/// A joint that follows beyond its own limit: the leader's range gives way, and the model and the
/// physics agree.
TEST(Locked, LeadersGoNoFurtherThanWhatFollows) {
  std::string urdf = made_hands::four_fingers();
  const std::size_t at = urdf.find("upper=\"1.4\"", urdf.find("\"ring_bend\""));
  urdf.replace(at, 11, "upper=\"0.8\"");
  const auto hand =
      planner::make_hand(read(urdf), "short", planner::mesh_files("."), {.samples = 20});
  ASSERT_TRUE(hand) << hand.error().message();
  for (const model::HandJoint& joint : hand->model.joints()) {
    const model::HandDof& dof = hand->model.dofs()[static_cast<std::size_t>(joint.dof)];
    for (const double value : {dof.lower, dof.upper}) {
      EXPECT_GT(joint.multiplier * value + joint.offset, joint.lower - 1e-6) << joint.name;
      EXPECT_LT(joint.multiplier * value + joint.offset, joint.upper + 1e-6) << joint.name;
    }
    if (joint.name == "ring_base") {
      EXPECT_NEAR(dof.upper, 1.0, 1e-6);
    }
  }
}

}  // namespace
