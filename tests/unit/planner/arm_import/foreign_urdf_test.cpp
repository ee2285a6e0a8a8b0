// URDFs of arms as many makers write them: each becomes an arm that moves as its URDF says, or is
// refused by one clear line.
#include <gtest/gtest.h>

#include <functional>

#include "common/arm/inverse.hpp"
#include "services/planner/tools/arm_import/make_arm.hpp"
#include "services/planner/tools/hand_import/check.hpp"
#include "tests/support/arms/arms.hpp"

using namespace prehend;

namespace foreign {
namespace {

const planner::MeshReader no_meshes =
    [](const planner::Solid& solid) -> Expected<std::vector<Eigen::Vector3d>> {
  return fail("there is no such file", solid.mesh);
};
/// A block of 6 × 8 × 10 cm, whatever is asked for.
const planner::MeshReader blocks =
    [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.03, 0.03})
    for (const double y : {-0.04, 0.04})
      for (const double z : {-0.05, 0.05}) corners.emplace_back(x, y, z);
  return corners;
};

std::string with(std::string urdf, const std::string& more) {
  return urdf.insert(urdf.rfind("</robot>"), more);
}
std::string replaced(std::string text, const std::string& old, const std::string& by,
                     bool all = false) {
  std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::runtime_error("no " + old);
  for (; at != std::string::npos; at = all ? text.find(old, at + by.size()) : std::string::npos)
    text.replace(at, old.size(), by);
  return text;
}
std::string fixed(const std::string& name, const std::string& parent, const std::string& child) {
  return "<link name=\"" + child + "\"/><joint name=\"" + name +
         "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><origin xyz=\"0 0 0.1\"/></joint>";
}
std::string finger(const std::string& name, const std::string& parent, const std::string& how) {
  return "<link name=\"" + name + "\"/><joint name=\"" + name + "_joint\" type=\"prismatic\">" +
         "<parent link=\"" + parent + "\"/><child link=\"" + name + "\"/><axis xyz=\"0 1 0\"/>" +
         how + "</joint>";
}
const std::string slide = "<limit lower=\"0\" upper=\"0.04\" effort=\"20\" velocity=\"0.2\"/>";

struct Case {
  const char* name;
  std::size_t arm;  // of test::foreign_arms(): as a UR5, a Panda, an iiwa
  std::function<std::string(const std::string&)> edit;
  const char* refused = nullptr;  // words of the line; none: it is an arm
  const char* tip = "";
  bool meshes = false;  // are there
};

const std::string joint1_of_six = "lower=\"-6.283100\" upper=\"6.283100\"";
const std::string joint1_of_seven = "lower=\"-2.897300\" upper=\"2.897300\"";

std::string as_it_is(const std::string& urdf) {
  return urdf;
}

// Long: a table, a row a maker's way of writing.
const std::vector<Case>& cases() {
  static const std::string mesh_of =
      "<collision><geometry><mesh filename=\"package://maker_description/meshes/a.stl\" "
      "scale=\"0.001 0.001 0.001\"/></geometry></collision></link>";
  static const std::vector<Case> all{
      {"AsItIs", 0, as_it_is},
      {"Seven", 1, as_it_is},
      {"Round", 2, as_it_is},
      {"ToolFrames", 0,
       [](auto& u) {
         return with(u, fixed("a", "link6", "flange") + fixed("b", "flange", "tool0"));
       }},
      {"CameraBesideTheTool", 1,
       [](auto& u) {
         return with(u, fixed("a", "link7", "tool0") + fixed("b", "link4", "camera"));
       }},
      {"OnAWorldLink", 0,
       [](auto& u) {
         return with(u,
                     "<link name=\"world\"/><joint name=\"stand\" type=\"fixed\">"
                     "<parent link=\"world\"/><child link=\"base\"/></joint>");
       }},
      {"TransmissionsAndGazebo", 1,
       [](auto& u) {
         return with(u,
                     "<transmission name=\"t\"><type>x</type></transmission><gazebo "
                     "reference=\"link1\"><mu1>0.2</mu1></gazebo><ros2_control name=\"r\" "
                     "type=\"system\"><joint name=\"joint1\"/></ros2_control>");
       }},
      {"ContinuousWrist", 0,
       [](auto& u) {
         return replaced(u, "\"joint6\" type=\"revolute\"", "\"joint6\" type=\"continuous\"");
       }},
      {"NoEffortNorVelocity", 2,
       [](auto& u) { return replaced(u, " effort=\"80\"", " effort=\"0\"", true); }},
      {"SoftLimits", 1,
       [](auto& u) {
         return replaced(u, "</joint>",
                         "<safety_controller k_position=\"100\" k_velocity=\"40\" "
                         "soft_lower_limit=\"-1\" soft_upper_limit=\"1\"/></joint>");
       }},
      {"PluggedGripper", 1,
       [](auto& u) {
         return with(u, fixed("a", "link7", "hand") + finger("left", "hand", slide) +
                            finger("right", "hand", slide + "<mimic joint=\"left_joint\"/>"));
       },
       nullptr, "hand"},
      {"GripperWithoutItsLimits", 0,
       [](auto& u) {
         return with(u, fixed("a", "link6", "hand") + finger("left", "hand", "") +
                            finger("right", "hand", slide + "<mimic joint=\"nobody\"/>"));
       },
       nullptr, "hand"},
      {"GripperThatNobodyLeftOut", 1,
       [](auto& u) { return with(u, fixed("a", "link7", "hand") + finger("left", "hand", slide)); },
       "--tip"},
      {"MeshesThatAreThere", 0, [](auto& u) { return replaced(u, "</link>", mesh_of, true); },
       nullptr, "", true},
      {"MeshesOfAPackage", 0, [](auto& u) { return replaced(u, "</link>", mesh_of, true); },
       "there is no such file"},
      {"MissingLimits", 0,
       [](auto& u) {
         return replaced(u, "<limit " + joint1_of_six + " effort=\"80\" velocity=\"3.150000\"/>",
                         "");
       },
       "has no limits"},
      {"InvertedLimits", 1,
       [](auto& u) { return replaced(u, joint1_of_seven, "lower=\"2.8\" upper=\"-2.8\""); },
       "may move from 2.8 to -2.8"},
      {"Degrees", 1,
       [](auto& u) { return replaced(u, joint1_of_seven, "lower=\"-166\" upper=\"166\""); },
       "radians"},
      {"Millimetres", 0, [](auto& u) { return replaced(u, "0 0 0.39225", "0 0 392.25"); },
       "millimetres"},
      {"XacroThatNobodyRan", 0, [](auto& u) { return replaced(u, "0 0 0.39225", "0 0 ${a3}"); },
       "bad-number"},
      {"FloatingBase", 1,
       [](auto& u) { return replaced(u, "type=\"revolute\"", "type=\"floating\""); }, "floating"},
      {"OnARail", 0, [](auto& u) { return replaced(u, "type=\"revolute\"", "type=\"prismatic\""); },
       "slides"},
      {"FiveJoints", 0,
       [](auto& u) {
         return replaced(u, "\"joint3\" type=\"revolute\"", "\"joint3\" type=\"fixed\"");
       },
       "an arm has 6 or 7"},
      {"EightJoints", 1,
       [](auto& u) {
         return with(u,
                     "<link name=\"link8\"/><joint name=\"joint8\" type=\"revolute\"><parent "
                     "link=\"link7\"/><child link=\"link8\"/><limit lower=\"-1\" upper=\"1\" "
                     "effort=\"1\" velocity=\"1\"/></joint>");
       },
       "an arm has 6 or 7"},
      {"LinkOfTwoJoints", 2,
       [](auto& u) {
         return with(u,
                     "<joint name=\"rod\" type=\"fixed\"><parent link=\"base\"/>"
                     "<child link=\"link4\"/></joint>");
       },
       "hangs on two joints"},
  };
  return all;
}

class ForeignUrdf : public testing::TestWithParam<std::size_t> {
 protected:
  const Case& the = cases()[GetParam()];
};

TEST_P(ForeignUrdf, WorksOrIsRefusedByOneClearLine) {
  const test::ArmFiles& files = test::foreign_arms()[the.arm];
  const auto robot = planner::read_robot(the.edit(files.urdf));
  ASSERT_TRUE(robot) << robot.error().message();
  const auto& meshes = the.meshes ? blocks : no_meshes;
  const auto made = planner::make_arm(*robot, "made", meshes, the.tip);
  if (the.refused) {
    ASSERT_FALSE(made);
    std::string line = made.error().message();
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_FALSE(made.error().hint.empty()) << line;
    for (const auto& finding : planner::check_arm(*robot, meshes, the.tip))
      line += " " + finding.code;
    EXPECT_NE(line.find(the.refused), std::string::npos) << line;
    return;
  }
  ASSERT_TRUE(made) << made.error().message();
  const model::ArmModel& original = test::arm(files.name);
  ASSERT_EQ(made->model.joints.size(), original.joints.size());
  // Its last link moves as that of the arm without what was added.
  Random random(GetParam());
  const arm::Inverse inverse(made->model);
  for (int k = 0; k < 5; ++k) {
    const arm::Joints q = test::random_posture(made->model, random);
    const auto moved = [&](const model::ArmModel& model) {
      const std::size_t last = model.joints.size();
      return Pose(arm::forward(model, made->model.home).X_AL[last].inverse() *
                  arm::forward(model, q).X_AL[last]);
    };
    EXPECT_LT((moved(made->model).matrix() - moved(original).matrix()).norm(), 1e-9);
    const Pose X_AE = arm::end_pose(made->model, q);
    const auto branches = made->model.redundant < 0
                              ? inverse.branches(X_AE)
                              : inverse.branches(X_AE, q[made->model.redundant]);
    EXPECT_FALSE(branches.empty());
    for (const arm::Joints& branch : branches)
      EXPECT_LT(arm::way_between(arm::end_pose(made->model, branch), X_AE).norm(), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Makers, ForeignUrdf, testing::Range<std::size_t>(0, cases().size()),
                         [](const auto& one) { return cases()[one.param].name; });

}  // namespace
}  // namespace foreign
