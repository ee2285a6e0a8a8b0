// What the two files of a hand may say, on a small hand made for it: couplings, sliding joints,
// clutches, fixed joints, and for everything else a refusal that names the file and the element.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "common/model/hand_model.hpp"

namespace {

using namespace prehend;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the hand has no " + from);
  return text.replace(at, from.size(), to);
}

std::string link(const std::string& name, const std::string& mass = "1.0") {
  return "<link name='" + name + "'><inertial><mass value='" + mass +
         "'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>"
         "<collision><geometry><sphere radius='0.01'/></geometry></collision></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/>" + more +
         "<limit lower='-0.5' upper='0.5' effort='2' velocity='3'/></joint>";
}

/// A thumb that slides along x and, coupled to it, a knuckle that turns about z at 10 rad/m with a
/// pad fixed to it; a finger that turns by itself.
const std::string urdf =
    "<robot name='small'>" + link("palm") + link("slide") + link("knuckle") + link("pad") +
    link("finger") +
    joint("slide", "prismatic", "palm", "slide", "<origin xyz='0 0.1 0'/><axis xyz='1 0 0'/>") +
    joint("knuckle", "revolute", "slide", "knuckle",
          "<origin xyz='0 0 0.2'/><axis xyz='0 0 1'/><mimic joint='slide' multiplier='10' "
          "offset='0.25'/>") +
    joint("glue", "fixed", "knuckle", "pad", "<origin xyz='0.4 0 0' rpy='0 0 0'/>") +
    joint("finger", "revolute", "palm", "finger", "<axis xyz='0 0 1'/>") + "</robot>";

const std::string toml = R"(
name = "small"
[grasp_frame]
position = [0, 0, 0.1]
orientation = [1, 0, 0, 0]
[[dof]]
name = "thumb"
joint = "slide"
upper = 0.025
lower = -0.025
closing = -1
squeeze = 0.002
[[dof]]
name = "finger"
joint = "finger"
closing = 1
[[fingertip]]
name = "thumb"
link = "knuckle"
position = [0.4, 0, 0]
[[fingertip]]
name = "finger"
link = "finger"
position = [0.1, 0, 0]
[torque]
finger = 0.7
[breakaway]
slide = 1.5
[materials]
default = "rubber"
palm = "metal"
[postures]
open = [0.025, 0.0]
)";

template <class Items>
const auto& named(const Items& items, std::string_view name) {
  for (const auto& item : items)
    if (item.name == name) return item;
  throw std::runtime_error("no " + std::string(name));
}

TEST(HandFile, ReadsSlidingJointsCouplingsAndClutches) {
  const auto hand = model::HandModel::parse(urdf, toml);
  ASSERT_TRUE(hand) << hand.error().message();
  ASSERT_EQ(hand->joints().size(), 3u);
  EXPECT_EQ(named(hand->joints(), "slide").kind, model::JointKind::prismatic);
  EXPECT_EQ(named(hand->joints(), "knuckle").kind, model::JointKind::revolute);
  EXPECT_EQ(named(hand->joints(), "slide").breakaway, 1.5);
  EXPECT_EQ(named(hand->joints(), "knuckle").breakaway, std::nullopt);
  EXPECT_EQ(named(hand->joints(), "knuckle").multiplier, 10);
  EXPECT_EQ(named(hand->joints(), "knuckle").offset, 0.25);
  EXPECT_EQ(named(hand->joints(), "slide").max_torque, 2);
  EXPECT_EQ(named(hand->joints(), "finger").max_torque, 0.7);
  EXPECT_EQ(hand->dofs()[0].kind, model::JointKind::prismatic);
  EXPECT_EQ(hand->joints()[static_cast<std::size_t>(hand->dofs()[0].joint)].name, "slide");
  EXPECT_EQ(hand->dofs()[0].upper, 0.025);
  EXPECT_EQ(hand->dofs()[0].squeeze, 0.002);
  EXPECT_EQ(hand->dofs()[0].max_velocity, 3);
  EXPECT_EQ(hand->dofs()[1].squeeze, 0.15);
  EXPECT_EQ(named(hand->links(), "palm").material, "metal");
  EXPECT_EQ(named(hand->links(), "knuckle").material, "rubber");
  EXPECT_EQ(named(hand->links(), "palm").finger, -1);
  EXPECT_EQ(named(hand->links(), "slide").finger, 0);
  EXPECT_EQ(named(hand->links(), "knuckle").finger, 0);
  EXPECT_EQ(named(hand->links(), "finger").finger, 1);
}

TEST(HandFile, SlidesAndTurnsAsCoupled) {
  const auto hand = model::HandModel::parse(urdf, toml);
  ASSERT_TRUE(hand) << hand.error().message();
  const auto tips = hand->fingertip_positions(Eigen::Vector2d(0.01, 0.5));
  const double turn = 10 * 0.01 + 0.25;
  EXPECT_LT(
      (tips[0] - Vector3d(0.01 + 0.4 * std::cos(turn), 0.1 + 0.4 * std::sin(turn), 0.2)).norm(),
      1e-15);
  EXPECT_LT((tips[1] - Vector3d(0.1 * std::cos(0.5), 0.1 * std::sin(0.5), 0)).norm(), 1e-15);
}

// Two equal masses 0.4 m apart: their centre lies between, and each adds its own inertia and
// m (0.2 m)² across the line that joins them.
TEST(HandFile, JoinsLinksOfFixedJoints) {
  const auto hand = model::HandModel::parse(urdf, toml);
  ASSERT_TRUE(hand) << hand.error().message();
  ASSERT_EQ(hand->links().size(), 4u);
  const model::HandLink& knuckle = named(hand->links(), "knuckle");
  EXPECT_EQ(knuckle.mass, 2);
  EXPECT_LT((knuckle.com_L - Vector3d(0.2, 0, 0)).norm(), 1e-15);
  const Eigen::Matrix3d expected = Vector3d(0.2, 0.28, 0.28).asDiagonal();
  EXPECT_LT((knuckle.inertia_L - expected).cwiseAbs().maxCoeff(), 1e-15);
  ASSERT_EQ(knuckle.collision.size(), 2u);
  EXPECT_LT((knuckle.collision[1].X_LS.translation() - Vector3d(0.4, 0, 0)).norm(), 1e-15);
}

struct Wrong {
  bool in_urdf;
  const char* from;
  const char* to;
  const char* names;  // what the message must say
};

TEST(HandFile, RefusesWhatIsNoHandAndSaysWhere) {
  for (const Wrong& wrong : std::initializer_list<Wrong>{
           {true, "<robot", "<rabbit", "is not XML"},
           {true, "<robot name='small'>", "", "robot description"},
           {true, "radius='0.01'", "radius='nan'", "collision"},
           {true, "radius='0.01'", "radius='-1'", "collision"},
           {true, "<sphere radius='0.01'/>", "<capsule radius='1' length='1'/>", "collision"},
           {true, "<sphere radius='0.01'/>", "<mesh filename='a.stl'/>", "palm"},
           {true, "value='1.0'", "value='0'", "palm"},
           {true, "value='1.0'", "value='inf'", "palm"},
           {true, "<collision>", "<collision><origin xyz='1e9 0 0'/>", "is not finite or far away"},
           {true, "ixx='0.1'", "ixx='-0.1'", "palm"},
           {true, "ixy='0'", "ixy='0.2'", "palm"},
           {true, "xyz='0 0.1 0'", "xyz='0 nan 0'", "robot description"},
           {true, "xyz='1 0 0'", "xyz='0 0 0'", "slide"},
           {true, "lower='-0.5'", "lower='0.6'", "slide"},
           {true, "effort='2'", "effort='0'", "slide"},
           {true, "velocity='3'", "velocity='0'", "thumb"},
           {true, "type='revolute'", "type='continuous'", "knuckle"},
           {true, "type='revolute'", "type='floating'", "knuckle"},
           {true, "mimic joint='slide'", "mimic joint='nobody'", "nobody"},
           {true, "mimic joint='slide'", "mimic joint='knuckle'", "loop"},
           {true, "multiplier='10'", "multiplier='0'", "knuckle"},
           {true, "parent link='palm'", "parent link='knuckle'", ""},
           {true, "child link='finger'", "child link='knuckle'", ""},
           {false, "name = \"small\"", "name = ", "line 2"},
           {false, "name = \"small\"", "", "name"},
           {false, "closing = -1", "closing = -2", "thumb"},
           {false, "closing = -1", "closing = \"in\"", "thumb"},
           {false, "closing = -1", "closnig = -1", "closnig"},
           {false, "squeeze = 0.002", "squeeze = 0.0", "thumb"},
           {false, "closing = -1", "closing = -1\ncoupling = \"soft\"", "soft"},
           {false, "closing = -1", "closing = -1\ncoupling = \"rigid\"", "springs"},
           {false, "upper = 0.025", "upper = 0.6", "thumb"},
           {false, "upper = 0.025", "upper = -0.1", "thumb"},
           {false, "upper = 0.025", "upper = nan", "upper is not a finite number"},
           {false, "joint = \"slide\"", "joint = \"knuckle\"", "knuckle"},
           {false, "joint = \"slide\"", "joint = \"finger\"", "finger"},
           {false, "joint = \"slide\"", "joint = \"nobody\"", "nobody"},
           {false, "name = \"thumb\"", "name = \"finger\"", "two of this name"},
           {false, "link = \"knuckle\"", "link = \"pad\"", "pad"},
           {false, "position = [0.4, 0, 0]", "position = [0.4, 0]", "thumb"},
           {false, "finger = 0.7", "finger = -0.7", "finger"},
           {false, "finger = 0.7", "thumb = 0.7", "torque.thumb"},
           {false, "slide = 1.5", "slide = 2.5", "breakaway.slide"},
           {false, "slide = 1.5", "knuckle = 1.5", "breakaway.knuckle"},
           {false, "slide = 1.5", "finger = 0.5", "breakaway.finger"},
           {false, "default = \"rubber\"", "", "materials"},
           {false, "palm = \"metal\"", "hand = \"metal\"", "materials.hand"},
           {false, "orientation = [1, 0", "orientation = [0, 0", "grasp_frame"},
           {false, "[torque]", "[reach]\nopening = 0.0\n[torque]", "reach.opening"},
           {false, "[torque]", "[torques]", "torques"},
           {false, "[torque]", "[gate]\neffort = [1.0, 0.0]\n[torque]", "positive"},
           {false, "[torque]", "[gate]\neffort = [1.0]\n[torque]", "gate.effort"},
           {false, "[torque]", "[gate]\nlower = [0.03, 0.0]\n[torque]",
            "gate: needs lower < upper, within the limits of DoF thumb"},
           {false, "[torque]", "[gate]\neffort = [1.0, 0.8]\n[torque]", "gate.effort"},
           {false, "open = [0.025, 0.0]", "open = [0.025]", "postures.open"},
           {false, "open = [0.025, 0.0]", "open = [0.03, 0.0]", "thumb"},
           {false, "open = [0.025, 0.0]", "shut = [0.025, 0.0]", "open"}}) {
    const auto hand =
        model::HandModel::parse(wrong.in_urdf ? replaced(urdf, wrong.from, wrong.to) : urdf,
                                wrong.in_urdf ? toml : replaced(toml, wrong.from, wrong.to));
    ASSERT_FALSE(hand) << wrong.from << " -> " << wrong.to;
    const std::string message = hand.error().message();
    EXPECT_NE(message.find(wrong.names), std::string::npos)
        << wrong.from << " -> " << wrong.to << ": " << message;
    EXPECT_TRUE(message.starts_with("hand.urdf") || message.starts_with("hand.toml")) << message;
  }
}

TEST(HandFile, RefusesWhatMovesNothingAndWhatHasTooMuch) {
  std::string links, joints;
  for (int i = 0; i < 256; ++i) {
    const std::string name = "part" + std::to_string(i);
    links += link(name);
    joints += joint(name, "fixed", "palm", name, "");
  }
  const auto refused = [](const std::string& parts) {
    return model::HandModel::parse("<robot name='small'>" + link("palm") + parts + "</robot>", toml)
        .error()
        .message();
  };
  EXPECT_EQ(refused(""), "hand.urdf: has no joint that moves");
  EXPECT_EQ(refused(links + joints), "hand.urdf: has more than 256 links");
  EXPECT_EQ(refused("<link name='bare'/>" +
                    joint("turn", "revolute", "palm", "bare", "<axis xyz='0 0 1'/>")),
            "hand.urdf: bare: link has no mass (give it an <inertial>)");
}

// The parser keeps a link under both of its parents, which could make its tree endless.
TEST(HandFile, RefusesLoopsOfLinks) {
  const std::string looped =
      replaced(urdf, "</robot>",
               joint("back", "revolute", "knuckle", "slide", "<axis xyz='0 0 1'/>") + "</robot>");
  EXPECT_FALSE(model::HandModel::parse(looped, toml));
}

TEST(HandFile, NamesTheFolder) {
  const auto nothing = model::HandModel::load("/nowhere");
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().message().find("/nowhere/hand.urdf"), std::string::npos);
  const auto folder = std::filesystem::path(testing::TempDir()) / "small_hand";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "hand.urdf") << urdf;
  std::ofstream(folder / "hand.toml") << replaced(toml, "closing = 1", "closing = 3");
  const auto wrong = model::HandModel::load(folder);
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message().find((folder / "hand.toml").string()), std::string::npos)
      << wrong.error().message();
}

TEST(HandFile, WhatOthersNameIsAHandOfOursAndNoPath) {
  for (const std::string& name : model::hand_names()) {
    const auto folder = model::named_hand(name);
    ASSERT_TRUE(folder) << folder.error().message();
    EXPECT_TRUE(model::HandModel::load(*folder));
  }
  ASSERT_FALSE(model::hand_names().empty());
  const std::string path = model::hand_directory(model::hand_names().front()).string();
  for (const std::string& name :
       {path, std::string("../hands/") + model::hand_names().front(), std::string(".."),
        std::string("/etc"), std::string("no_such_hand"), std::string()})
    EXPECT_FALSE(model::named_hand(name)) << name;
}

}  // namespace
