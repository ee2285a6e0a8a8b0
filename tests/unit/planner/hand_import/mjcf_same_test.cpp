// Every hand of the lab written as MJCF, in several ways, and read again is the same robot: at
// random values of its joints each link stands where it stood, with the same mass and shapes.
// Numbers are written with all digits, so what differs is rounding of products: 1e-9.
#include <gtest/gtest.h>

#include <numeric>

#include "common/base/file_text.hpp"
#include "common/base/random.hpp"
#include "services/planner/tools/hand_import/mjcf.hpp"
#include "services/planner/tools/hand_import/tree.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/mjcf/mjcf_text.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;
using planner::Robot;

constexpr double rounding = 1e-9;

class SameHand : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto text =
        read_file(test::in_sources("common/models/hands/" + GetParam() + "/hand.urdf"));
    ASSERT_TRUE(text) << text.error().message();
    auto robot = planner::read_robot(*text);
    ASSERT_TRUE(robot) << robot.error().message();
    urdf = std::move(*robot);
  }

  Robot urdf;
};

/// Values of a robot's joints by those of joints of the same names that lead in another.
std::vector<double> values(const Robot& robot, const std::map<std::string, double>& leading) {
  std::vector<double> all;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const auto leader = planner::leader_of(robot, i);
    const std::string& name = robot.joints[leader ? leader->joint : i].name;
    const auto found = leading.find(name);
    const double value = found == leading.end() ? 0 : found->second;
    all.push_back(leader ? leader->multiplier * value + leader->offset : value);
  }
  return all;
}

void expect_same(const Pose& a, const Pose& b, const std::string& what) {
  EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), rounding) << what;
}

void expect_same_link(const planner::RobotLink& a, const planner::RobotLink& b, const Pose& X_AB) {
  ASSERT_EQ(a.inertial.has_value(), b.inertial.has_value()) << a.name;
  if (a.inertial) {
    EXPECT_NEAR(a.inertial->mass, b.inertial->mass, rounding) << a.name;
    const Pose X = X_AB * b.inertial->X_LI;
    EXPECT_LT((a.inertial->X_LI.translation() - X.translation()).norm(), rounding) << a.name;
    const auto along = [](const Pose& P, const Eigen::Matrix3d& i) -> Eigen::Matrix3d {
      return P.linear() * i * P.linear().transpose();
    };
    EXPECT_LT((along(a.inertial->X_LI, a.inertial->inertia_I) - along(X, b.inertial->inertia_I))
                  .cwiseAbs()
                  .maxCoeff(),
              rounding)
        << a.name;
  }
  ASSERT_EQ(a.collision.size(), b.collision.size()) << a.name;
  for (std::size_t i = 0; i < a.collision.size(); ++i) {
    EXPECT_EQ(a.collision[i].shape.kind, b.collision[i].shape.kind) << a.name;
    EXPECT_LT((a.collision[i].shape.size - b.collision[i].shape.size).norm(), rounding) << a.name;
    expect_same(a.collision[i].X_LS, X_AB * b.collision[i].X_LS, a.name);
  }
}

TEST_P(SameHand, AsMjcf) {
  for (const test::MjcfStyle style : {test::MjcfStyle{},
                                      {.degrees = true},
                                      {.defaults = true},
                                      {.moved = true},
                                      {.degrees = true, .defaults = true, .moved = true}}) {
    const std::string text = test::mjcf_of(urdf, style);
    const auto robot = planner::read_mjcf(text);
    ASSERT_TRUE(robot) << robot.error().message();
    for (const planner::UrdfFinding& finding : robot->findings)
      EXPECT_EQ(finding.severity, planner::Severity::warning) << finding.what << "\n" << text;
    ASSERT_EQ(robot->links.size(), urdf.links.size());
    ASSERT_EQ(robot->joints.size(), urdf.joints.size());
    // A link whose joint moves it has the axes of its body, where the joint is.
    const Pose turned =
        make_pose(Eigen::Vector3d::Zero(), Eigen::Matrix3d(test::moved_by().linear()));
    std::map<std::string, Pose> X_AB;
    for (const planner::RobotLink& link : urdf.links) X_AB[link.name] = Pose::Identity();
    for (const planner::RobotJoint& joint : urdf.joints)
      if (style.moved && joint.moves()) X_AB[joint.child] = turned;
    for (const planner::RobotLink& link : urdf.links) {
      ASSERT_TRUE(robot->find_link(link.name)) << link.name;
      expect_same_link(link, *robot->find_link(link.name), X_AB.at(link.name));
    }
    Random random(1);
    for (int trial = 0; trial < 20; ++trial) {
      std::map<std::string, double> leading;
      for (const planner::RobotJoint& joint : urdf.joints)
        if (joint.limit)
          leading[joint.name] = random.uniform(joint.limit->lower, joint.limit->upper);
      const std::string root = planner::Tree(urdf).roots().at(0);
      const auto a = planner::Tree(urdf).poses(root, values(urdf, leading));
      const auto b = planner::Tree(*robot).poses(root, values(*robot, leading));
      for (const auto& [name, X] : a) expect_same(X * X_AB.at(name), b.at(name), name);
    }
  }
}

TEST_P(SameHand, KeepsLimitsAndEfforts) {
  const auto robot = planner::read_mjcf(test::mjcf_of(urdf, {.degrees = true}));
  ASSERT_TRUE(robot) << robot.error().message();
  for (const planner::RobotJoint& joint : urdf.joints) {
    const planner::RobotJoint* same = robot->find_joint(joint.name);
    ASSERT_TRUE(same || !joint.moves()) << joint.name;
    if (!joint.moves() || !joint.limit) continue;
    EXPECT_EQ(same->type, joint.type) << joint.name;
    EXPECT_NEAR(same->limit->lower, joint.limit->lower, rounding) << joint.name;
    EXPECT_NEAR(same->limit->upper, joint.limit->upper, rounding) << joint.name;
    if (!joint.mimic) {
      EXPECT_NEAR(same->limit->effort, joint.limit->effort, rounding) << joint.name;
    }
    EXPECT_EQ(same->mimic.has_value(), joint.mimic.has_value()) << joint.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SameHand, testing::ValuesIn(test::hand_names()));

}  // namespace
