// Every hand of the lab made again from its URDF alone, compared with its hand-written hand.toml.
// Fingertips: within 15 mm. The hand-written ones lie on the axis of the last link at its end;
// found ones in the middle of the end of its shapes, which may be as thick as a finger (15 mm) to
// one side. Closing: the sign of every DoF; where a person decided otherwise it is named below,
// with why.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "services/planner/tools/hand_import/make_hand.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;
using Eigen::Vector3d;

std::filesystem::path folder() {
  return std::filesystem::path(test::in_sources("common/models/hands"));
}

std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class EveryHand : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto loaded = model::HandModel::load(folder() / GetParam());
    ASSERT_TRUE(loaded) << loaded.error().message();
    written = std::move(*loaded);
    made = once();
    ASSERT_TRUE(made);
  }

  /// The search for the grasp frame takes a second, so each hand is made once for all tests.
  static const planner::MadeHand* once() {
    static std::map<std::string, planner::MadeHand> hands;
    const auto found = hands.find(GetParam());
    if (found != hands.end()) return &found->second;
    const auto robot = planner::read_robot(read(folder() / GetParam() / "hand.urdf"));
    if (!robot) return nullptr;
    auto hand = planner::make_hand(*robot, GetParam(), planner::mesh_files(folder()));
    EXPECT_TRUE(hand);
    return hand ? &hands.emplace(GetParam(), std::move(*hand)).first->second : nullptr;
  }

  model::HandModel written;
  const planner::MadeHand* made = nullptr;
};

TEST_P(EveryHand, HasNoErrors) {
  for (const planner::UrdfFinding& finding : made->findings)
    EXPECT_EQ(finding.severity, planner::Severity::warning) << finding.element << finding.what;
  EXPECT_TRUE(made->opposed);
}

TEST_P(EveryHand, KeepsItsFingertips) {
  ASSERT_EQ(made->model.fingertips().size(), written.fingertips().size());
  for (const model::HandFingertip& tip : written.fingertips()) {
    const std::string& link = written.links()[static_cast<std::size_t>(tip.link)].name;
    double nearest = 1e9;
    for (const model::HandFingertip& other : made->model.fingertips())
      if (made->model.links()[static_cast<std::size_t>(other.link)].name == link)
        nearest = std::min(nearest, (other.p_LT - tip.p_LT).norm());
    // Of a gripper the middle of the pad is written, which lies behind a bar or not.
    const bool slides = written.dofs()[0].kind == model::JointKind::prismatic;
    const bool is_gripper = written.dofs().size() == 1;
    EXPECT_LT(nearest, slides ? 0.025 : is_gripper ? 0.04 : 0.005) << link;
  }
}

TEST_P(EveryHand, FindsWhichWayItCloses) {
  ASSERT_EQ(made->model.dofs().size(), written.dofs().size());
  for (const model::HandDof& dof : written.dofs()) {
    const std::string& joint = written.joints()[static_cast<std::size_t>(dof.joint)].name;
    // Robonaut's palm cups about nearly the axis of the finger that it carries, and the base of the
    // human thumb was written as closing because it swings against the fingers, as the abduction of
    // Rutgers' thumb was.
    if (joint == "little_cup" || joint == "thumb_metacarpal") continue;
    if (GetParam() == "rutgers" && joint == "thumb_abduct") continue;
    for (const model::HandDof& other : made->model.dofs()) {
      if (made->model.joints()[static_cast<std::size_t>(other.joint)].name != joint) continue;
      EXPECT_EQ(other.closing, dof.closing) << joint;
    }
  }
}

TEST_P(EveryHand, KeepsItsKinematicsMassesAndShapes) {
  ASSERT_EQ(made->model.joints().size(), written.joints().size());
  for (std::size_t i = 0; i < written.joints().size(); ++i) {
    const auto &a = written.joints()[i], &b = made->model.joints()[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_LT((a.X_PJ.matrix() - b.X_PJ.matrix()).cwiseAbs().maxCoeff(), 1e-12) << a.name;
    EXPECT_LT((a.axis_J - b.axis_J).norm(), 1e-12) << a.name;
    EXPECT_EQ(a.multiplier, b.multiplier);
    EXPECT_EQ(a.offset, b.offset);
  }
  for (std::size_t i = 0; i < written.links().size(); ++i) {
    const auto &a = written.links()[i], &b = made->model.links()[i];
    EXPECT_NEAR(a.mass, b.mass, 1e-12) << a.name;
    EXPECT_LT((a.com_L - b.com_L).norm(), 1e-12) << a.name;
    // What moves carries a rotor.
    const Eigen::Matrix3d rotor = (i == 0 ? 0.0 : 1e-4) * Eigen::Matrix3d::Identity();
    EXPECT_LT((a.inertia_L + rotor - b.inertia_L).cwiseAbs().maxCoeff(), 1e-12) << a.name;
    EXPECT_EQ(a.collision.size(), b.collision.size()) << a.name;
  }
}

TEST_P(EveryHand, LooksOutOfThePalmAsWritten) {
  const Eigen::Matrix3d R = written.X_BG().linear().transpose() * made->model.X_BG().linear();
  // The RH56 is written leaning from the palm's normal towards its open fingers, by 35 degrees.
  EXPECT_GT(R(2, 2), GetParam() == "inspire_rh56" ? 0.6 : 0.9);
  // The thumbs of these lie beside the palm and swing where no sign of closing leads them.
  if (GetParam() != "robonaut" && GetParam() != "rutgers" && GetParam() != "inspire_rh56") {
    EXPECT_GT(R(1, 1), 0.8);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryHand, testing::ValuesIn(test::hand_names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
