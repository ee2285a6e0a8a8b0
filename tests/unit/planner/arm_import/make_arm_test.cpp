// A URDF as somebody else wrote it becomes an arm that moves as that URDF says.
#include "services/planner/tools/arm_import/make_arm.hpp"

#include <gtest/gtest.h>

#include "common/arm/collision.hpp"
#include "services/planner/tools/hand_import/check.hpp"
#include "tests/support/arms/arms.hpp"

using namespace prehend;

namespace {

const planner::MeshReader no_meshes =
    [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
  return fail("there is no mesh");
};

std::string with(const std::string& urdf, const std::string& more) {
  std::string text = urdf;
  return text.insert(text.rfind("</robot>"), more);
}

const char* tool =
    "<link name=\"tool0\"/><joint name=\"tool_fixed\" type=\"fixed\"><parent link=\"link7\"/>"
    "<child link=\"tool0\"/><origin xyz=\"0 0 0.107\" rpy=\"0 0 0\"/></joint>";

const char* finger =
    "<link name=\"finger\"><collision><geometry><box size=\"0.01 0.01 0.05\"/></geometry>"
    "</collision></link><joint name=\"finger_joint\" type=\"prismatic\"><parent link=\"tool0\"/>"
    "<child link=\"finger\"/><axis xyz=\"0 1 0\"/><limit lower=\"0\" upper=\"0.04\" effort=\"20\" "
    "velocity=\"0.2\"/></joint>";

TEST(MakeArm, MovesAsItsUrdfSays) {
  const test::ArmFiles& files = test::foreign_arms()[1];
  const auto robot = planner::read_robot(with(files.urdf, tool));
  ASSERT_TRUE(robot);
  const auto made = planner::make_arm(*robot, "made", no_meshes);
  ASSERT_TRUE(made) << made.error().message();
  const model::ArmModel& original = test::arm(files.name);
  Random random(1);
  for (int k = 0; k < 50; ++k) {
    const arm::Joints q = test::random_posture(original, random);
    EXPECT_LT((arm::end_pose(made->model, q).matrix() - arm::end_pose(original, q).matrix()).norm(),
              1e-9);
  }
  EXPECT_TRUE(arm::is_within_limits(made->model, made->model.home));
  EXPECT_GT(
      arm::Collision(made->model, {}).clearance(arm::forward(made->model, made->model.home), 1), 0);
}

TEST(MakeArm, AHandAtTheEndNeedsATip) {
  const auto robot =
      planner::read_robot(with(test::foreign_arms()[1].urdf, std::string(tool) + finger));
  ASSERT_TRUE(robot);
  const auto findings = planner::check_arm(*robot, no_meshes);
  EXPECT_FALSE(planner::is_usable(findings));
  EXPECT_NE(findings.front().repair.find("--tip"), std::string::npos) << findings.front().repair;
  const auto made = planner::make_arm(*robot, "made", no_meshes, "tool0");
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(made->model.joints.size(), 7u);
  EXPECT_FALSE(planner::make_arm(*robot, "made", no_meshes, "nowhere"));
}

struct Fault {
  const char *old, *by, *code;
};

class ArmFaults : public testing::TestWithParam<Fault> {};

TEST_P(ArmFaults, AreNamedWithTheirMend) {
  std::string text = test::foreign_arms()[1].urdf;
  const std::size_t at = text.find(GetParam().old);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().old).size(), GetParam().by);
  const auto robot = planner::read_robot(text);
  ASSERT_TRUE(robot);
  const auto findings = planner::check_arm(*robot, no_meshes);
  EXPECT_FALSE(planner::is_usable(findings));
  bool named = false;
  for (const auto& finding : findings) {
    named |= finding.code == GetParam().code;
    EXPECT_FALSE(finding.repair.empty());
  }
  EXPECT_TRUE(named) << findings.front().code;
}

INSTANTIATE_TEST_SUITE_P(
    Urdf, ArmFaults,
    testing::Values(
        Fault{"<limit lower=\"-2.897300\" upper=\"2.897300\" effort=\"80\" velocity=\"2.175000\"/>",
              "", "no-limits"},
        Fault{"lower=\"-2.897300\" upper=\"2.897300\"", "lower=\"3\" upper=\"-3\"", "no-limits"},
        Fault{"type=\"revolute\"", "type=\"prismatic\"", "slides"},
        Fault{"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>", "zero-axis"},
        Fault{"<child link=\"link3\"/>", "<child link=\"link9\"/>", "missing-link"},
        Fault{"xyz=\"0 0 0.333\"", "xyz=\"0 0 333\"", "units"},
        Fault{"xyz=\"0 0 0.333\"", "xyz=\"0 0 inf\"", "bad-number"}));

}  // namespace
