// Each way in which a URDF may be broken, on a small gripper made for it, and the finding that must
// name it: by code, element, and line where the element stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "services/planner/tools/hand_import/anatomy.hpp"
#include "services/planner/tools/hand_import/check.hpp"
#include "tests/unit/planner/hand_import/made_hands.hpp"

namespace {

using namespace prehend;

Expected<std::vector<Eigen::Vector3d>> block(const planner::Solid& solid) {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-30, 30})
    for (const double y : {-50, 50})
      for (const double z : {-20, 20})
        corners.push_back(solid.scale.cwiseProduct(Eigen::Vector3d(x, y, z)));
  return corners;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the hand has no " + from);
  return text.replace(at, from.size(), to);
}

std::vector<planner::UrdfFinding> findings_of(const std::string& urdf,
                                              const planner::MeshReader& meshes = block) {
  const auto robot = planner::read_robot(urdf);
  if (!robot) throw std::runtime_error(robot.error().message());
  return planner::check(*robot, meshes);
}

struct Broken {
  const char* from;
  const char* to;
  const char* code;
  const char* element;
  bool usable;
};

constexpr const char* sound_limit =
    "<limit lower=\"0\" upper=\"0.04\" effort=\"40\" velocity=\"0.1\"/>";

const Broken broken_urdfs[] = {
    {"<box size=\"0.02 0.01 0.05\"/>", "<capsule radius=\"0.01\" length=\"0.05\"/>",
     "unknown-geometry", "link left_finger", false},
    {"<box size=\"0.02 0.01 0.05\"/>", "<box size=\"0.02 nan 0.05\"/>", "bad-number",
     "link left_finger", false},
    {"<box size=\"0.02 0.01 0.05\"/>", "<box size=\"0.02 0.01\"/>", "bad-number",
     "link left_finger", false},
    {"<box size=\"0.02 0.01 0.05\"/>", "<box size=\"0.02 0 0.05\"/>", "bad-size",
     "link left_finger", false},
    {"<box size=\"0.02 0.01 0.05\"/>", "<box size=\"20 10 50\"/>", "units", "link left_finger",
     false},
    {"<geometry><box size=\"0.02 0.01 0.05\"/></geometry>", "", "no-geometry", "link left_finger",
     false},
    {"scale=\"0.001 0.001 0.001\"", "", "units", "link body", true},
    {"scale=\"0.001 0.001 0.001\"", "scale=\"1000 1000 1000\"", "units", "link body", false},
    {sound_limit, "", "no-limits", "joint left_finger_slide", false},
    {sound_limit, "<limit effort=\"40\" velocity=\"0.1\"/>", "no-limits", "joint left_finger_slide",
     false},
    {"upper=\"0.04\"", "upper=\"0\"", "locked", "joint left_finger_slide", false},
    {"upper=\"0.04\"", "upper=\"-0.04\"", "no-limits", "joint left_finger_slide", false},
    {"upper=\"0.04\"", "upper=\"40\"", "units", "joint left_finger_slide", false},
    {"effort=\"40\"", "effort=\"0\"", "no-effort", "joint left_finger_slide", true},
    {"velocity=\"0.1\"", "", "no-velocity", "joint left_finger_slide", true},
    {"<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>", "zero-axis", "joint left_finger_slide",
     false},
    {"type=\"prismatic\"", "type=\"planar\"", "joint-type", "joint left_finger_slide", false},
    {"type=\"prismatic\"", "type=\"continuous\"", "continuous", "joint left_finger_slide", true},
    {"mimic joint=\"left_finger_slide\"", "mimic joint=\"nobody\"", "mimic-missing",
     "joint right_finger_slide", false},
    {"mimic joint=\"left_finger_slide\"", "mimic joint=\"right_finger_slide\"", "mimic-loop",
     "joint right_finger_slide", false},
    {"mimic joint=\"left_finger_slide\"", "mimic multiplier=\"0\" joint=\"left_finger_slide\"",
     "locked", "joint right_finger_slide", true},
    {"mimic joint=\"left_finger_slide\"", "mimic multiplier=\"2\" joint=\"left_finger_slide\"",
     "mimic-limit", "joint right_finger_slide", true},
    {"<mass value=\"0.1\"/>", "<mass value=\"0\"/>", "no-mass", "link left_finger", true},
    {"<mass value=\"0.1\"/>", "<mass value=\"-1\"/>", "no-mass", "link left_finger", false},
    {"<mass value=\"0.1\"/>", "<mass value=\"100\"/>", "units", "link left_finger", false},
    {"ixx=\"2e-05\"", "ixx=\"1\"", "impossible-inertia", "link left_finger", true},
    {"ixx=\"2e-05\"", "ixx=\"-1\"", "impossible-inertia", "link left_finger", true},
    {"<child link=\"left_pad\"/>", "<child link=\"nobody\"/>", "missing-link",
     "joint left_pad_screw", false},
    {"<child link=\"left_pad\"/>", "<child link=\"left_pad\"/><limit lower=\"x\"/>", "bad-number",
     "joint left_pad_screw", false},
    {"<child link=\"left_pad\"/>", "<child link=\"right_pad\"/>", "two-parents", "link right_pad",
     false},
    {"<child link=\"left_pad\"/>", "<child link=\"right_pad\"/>", "several-roots", "robot gripper",
     false},
    {"<parent link=\"mount\"/>", "<parent link=\"left_pad\"/>", "joint-loop", "link body", false},
    {"<link name=\"left_pad\">", "<link name=\"left_finger\">", "duplicate-name",
     "link left_finger", false},
    {"<link name=\"left_pad\">", "<link>", "no-name", "link ", false},
    {"xyz=\"0 0.009 0.02\"", "xyz=\"0 9 20\"", "units", "joint left_finger_slide", false},
    {"xyz=\"0 0.009 0.02\"", "xyz=\"0 -0.009 0.02\"", "self-collision", "link right_pad", true}};

TEST(HandCheck, FindsNothingWrongInASoundGripper) {
  for (const planner::UrdfFinding& finding : findings_of(made_hands::gripper())) {
    EXPECT_EQ(finding.severity, planner::Severity::warning) << finding.what;
    EXPECT_EQ(finding.code, "mesh-collision") << finding.element << ": " << finding.what;
  }
}

TEST(HandCheck, NamesWhatIsBroken) {
  const std::string sound = made_hands::gripper();
  for (const Broken& broken : broken_urdfs) {
    const std::string urdf = replaced(sound, broken.from, broken.to);
    const auto findings = findings_of(urdf);
    const bool named = std::any_of(findings.begin(), findings.end(), [&](const auto& finding) {
      return finding.code == broken.code && finding.element == broken.element &&
             !finding.repair.empty();
    });
    std::string all;
    for (const auto& finding : findings)
      all += finding.code + " " + finding.element + ": " + finding.what + "\n";
    EXPECT_TRUE(named) << broken.from << " -> " << broken.to << " must give " << broken.code
                       << " of " << broken.element << ", not\n"
                       << all;
    EXPECT_EQ(planner::is_usable(findings), broken.usable) << broken.to << "\n" << all;
  }
}

TEST(HandCheck, NamesMeshesThatAreNotThere) {
  const auto none = [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
    return fail("is not there");
  };
  const auto findings = findings_of(made_hands::gripper(), none);
  EXPECT_FALSE(planner::is_usable(findings));
  EXPECT_EQ(findings.front().code, "missing-mesh");
  EXPECT_EQ(findings.front().element, "link body");
  EXPECT_EQ(findings.front().line, 3);
}

TEST(HandCheck, RefusesWhatIsNoUrdf) {
  for (const std::string text : {"", "solid stl", "<sdf/>", "<robot>", "<robot name='a'"})
    EXPECT_FALSE(planner::read_robot(text)) << text;
  EXPECT_EQ(planner::read_robot("<robot>\n<xacro:if/></robot>").error().message(),
            "line 2: is xacro (`xacro FILE > FILE.urdf` makes a URDF of it)");
  EXPECT_FALSE(planner::is_usable(findings_of("<robot/>")));
  EXPECT_FALSE(planner::is_usable(findings_of("<robot><link name='a'/></robot>")));
}

// A brush is no hand.
TEST(Anatomy, OfMoreFingersThanAHandHasIsRefused) {
  const std::string block =
      "<collision><geometry><box size='.1 .1 .1'/></geometry></collision><inertial><mass "
      "value='.1'/><inertia ixx='1e-4' iyy='1e-4' izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial>";
  std::string urdf = "<robot name='brush'><link name='palm'>" + block + "</link>";
  for (int i = 0; i < 33; ++i) {
    const std::string hair = "hair" + std::to_string(i);
    urdf += "<link name='" + hair + "'>" + block + "</link><joint name='of_" + hair +
            "' type='revolute'><parent link='palm'/><child link='" + hair +
            "'/><axis xyz='1 0 0'/><limit lower='0' upper='1' effort='1' velocity='1'/>" +
            (i > 0 ? "<mimic joint='of_hair0'/>" : "") + "</joint>";
  }
  const auto found = planner::find_anatomy(planner::read_robot(urdf + "</robot>").value());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message(),
            "robot brush: 33 fingertips found, not 1 to 32 (a finger is a chain of moving links "
            "that ends somewhere)");
}

}  // namespace
