// Fingertips to robot postures, over all hands. The tests' targets are reachable by construction:
// fingertip positions f(q) of random postures q within the limits. A posture is not unique, so the
// answer is judged where it counts, at the fingertips: |f(answer) − f(q)| averaged over fingertips
// and 100 postures stays below 1 cm, the bound that dex-retargeting tests itself with. As there, a
// question starts near its answer (0.3 rad a DoF here), since frames follow each other closely;
// derivatives are checked against central differences, whose error is h² with h = 1e-6: 1e-8.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>

#include "common/base/random.hpp"
#include "services/mapping/core/retargeting/inverse_kinematics.hpp"
#include "services/mapping/core/retargeting/retargeter.hpp"
#include "services/mapping/core/retargeting/vector_matching.hpp"
#include "tests/support/hands.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd random_posture(const model::HandModel& model, Random& random) {
  VectorXd dof(static_cast<Eigen::Index>(model.dofs().size()));
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = model.dofs()[static_cast<std::size_t>(i)];
    dof[i] = random.uniform(limits.lower, limits.upper);
  }
  return dof;
}

/// 0.3 rad, or the same share of a revolute joint's 90° for what slides, away from a posture.
VectorXd near(const model::HandModel& model, const VectorXd& posture, Random& random) {
  VectorXd dof = posture;
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = model.dofs()[static_cast<std::size_t>(i)];
    const double unit =
        limits.kind == model::JointKind::prismatic ? (limits.upper - limits.lower) / 1.57 : 1;
    dof[i] += random.normal(0.3 * unit);
  }
  return model.clamp(dof);
}

HumanTips human_tips(const std::array<double, model::finger_count>& closure) {
  const model::HumanHand person(1);
  const auto poses = person.fingertip_poses(model::HumanHand::posture(closure));
  HumanTips p_GT;
  for (std::size_t f = 0; f < poses.size(); ++f)
    p_GT[f] = person.X_HG().inverse() * poses[f].translation();
  return p_GT;
}

const Vector3d p_GH = model::HumanHand(1).X_HG().inverse().translation();

class AllHands : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  FollowingTips tips_ = *FollowingTips::create(hand_);

  void expect_within_limits(const VectorXd& dof) const {
    ASSERT_TRUE(dof.allFinite());
    EXPECT_TRUE(hand_.clamp(dof).isApprox(dof, 1e-12));
  }
};

TEST_P(AllHands, KnowsHowItsFingertipsMove) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const VectorXd dof = random_posture(hand_, random);
    MatrixXd jacobian;
    const Matrix3Xd p = tips_.positions(dof, jacobian);
    EXPECT_TRUE(p.isApprox(tips_.positions(dof), 1e-12));
    constexpr double h = 1e-6;
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      VectorXd more = dof, less = dof;
      more[i] += h;
      less[i] -= h;
      const Matrix3Xd slope = (tips_.positions(more) - tips_.positions(less)) / (2 * h);
      EXPECT_LT((VectorXd::Map(slope.data(), slope.size()) - jacobian.col(i)).norm(), 1e-8);
    }
  }
}

TEST_P(AllHands, ReachesFingertipsByInverseKinematics) {
  Random random(7);
  double sum = 0;
  for (int k = 0; k < 100; ++k) {
    const VectorXd posture = random_posture(hand_, random);
    const Matrix3Xd wanted = tips_.positions(posture);
    const VectorXd answer = reach(tips_, wanted, near(hand_, posture, random));
    expect_within_limits(answer);
    sum += (tips_.positions(answer) - wanted).colwise().norm().mean();
  }
  RecordProperty("mean_error_mm", std::to_string(10 * sum));
  EXPECT_LT(sum / 100, 0.01);
}

TEST_P(AllHands, MatchesVectorsByOptimisation) {
  Random random(8);
  const Vector3d p_GB = hand_.X_BG().inverse().translation();
  double sum = 0;
  for (int k = 0; k < 100; ++k) {
    const VectorXd posture = random_posture(hand_, random);
    const Matrix3Xd wanted = tips_.positions(posture);
    const VectorXd answer =
        match_vectors(tips_, wanted.colwise() - p_GB, near(hand_, posture, random));
    expect_within_limits(answer);
    sum += (tips_.positions(answer) - wanted).colwise().norm().mean();
  }
  RecordProperty("mean_error_mm", std::to_string(10 * sum));
  EXPECT_LT(sum / 100, 0.01);
}

TEST_P(AllHands, AnswersWhateverTheHumanHandDoesWithoutJumping) {
  for (const Method method : {Method::cartesian, Method::vector}) {
    const auto retargeter = Retargeter::create(hand_, method);
    ASSERT_TRUE(retargeter);
    VectorXd before = hand_.postures().at("open");
    VectorXd again = before;
    for (int k = 0; k < 50; ++k) {
      const double c = 0.5 - 0.5 * std::cos(k * 0.2);
      const auto answer = retargeter->answer(human_tips({c, c, c, c, c}), p_GH, before);
      ASSERT_TRUE(answer);
      expect_within_limits(*answer);
      const auto same = retargeter->answer(human_tips({c, c, c, c, c}), p_GH, again);
      EXPECT_EQ(*answer, *same);
      again = *same;
      before = *answer;
    }
    // Out of reach, it still says something finite.
    HumanTips far;
    for (auto& tip : far) tip = Vector3d(10, -10, 10);
    const auto answer = retargeter->answer(far, p_GH, before);
    ASSERT_TRUE(answer);
    expect_within_limits(*answer);
  }
}

TEST_P(AllHands, RefusesMissingFingertips) {
  const auto retargeter = Retargeter::create(hand_, Method::cartesian);
  const VectorXd open = hand_.postures().at("open");
  HumanTips tips = human_tips({});
  tips[static_cast<std::size_t>(model::Finger::index)].reset();
  EXPECT_EQ(retargeter->answer(tips, p_GH, open).error().what, "fingertip missing");
  tips = human_tips({});
  tips[0]->y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(retargeter->answer(tips, p_GH, open).error().what, "fingertip not finite");
}

INSTANTIATE_TEST_SUITE_P(Retargeting, AllHands, testing::ValuesIn(test::hand_names()),
                         [](const auto& named) { return named.param; });

TEST(Retargeting, FingersThatFollowTheSameOneStayApart) {
  const FollowingTips tips = *FollowingTips::create(test::hand("barrett"));
  const Matrix3Xd p = *tips.targets(human_tips({}));
  const Matrix3Xd open = tips.positions(test::hand("barrett").postures().at("open"));
  const Vector3d index = *human_tips({})[static_cast<std::size_t>(model::Finger::index)];
  // Fingers 1 and 2 follow the index, finger 3 the thumb.
  EXPECT_NEAR(p(0, 0) - p(0, 1), open(0, 0) - open(0, 1), 1e-12);
  EXPECT_TRUE((0.5 * (p.col(0) + p.col(1))).isApprox(index, 1e-12));
  EXPECT_TRUE(p.col(2).isApprox(*human_tips({})[0], 1e-12));
}

// Hands made from any URDF do not say whom their fingers follow.
TEST(Retargeting, AHandWithoutFollowingFingersSaysSo) {
  const std::string urdf =
      "<robot name='stub'><link name='palm'><inertial><mass value='1'/><inertia ixx='1' iyy='1' "
      "izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link><link name='tip'><inertial><mass "
      "value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<joint name='j' type='revolute'><parent link='palm'/><child link='tip'/><axis xyz='0 0 1'/>"
      "<limit lower='0' upper='1' effort='1' velocity='1'/></joint></robot>";
  const auto toml = [](const std::string& tip) {
    return "name = 'stub'\n[grasp_frame]\nposition = [0, 0, 0]\norientation = [1, 0, 0, 0]\n[[dof]]"
           "\nname = 'd'\njoint = 'j'\nclosing = 1\n[[fingertip]]\nname = 'f'\nlink = 'tip'\n"
           "position = [0, 0, 0]\n" +
           tip + "[materials]\ndefault = 'rubber'\n[postures]\nopen = [0]\n";
  };
  const auto silent = model::HandModel::parse(urdf, toml(""));
  ASSERT_TRUE(silent) << silent.error().message();
  const auto made = Retargeter::create(*silent, Method::cartesian);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message(), testing::HasSubstr("human = \"index\""));
  const auto wrong = model::HandModel::parse(urdf, toml("human = 'toe'\n"));
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message(), testing::HasSubstr("«toe»"));
  EXPECT_TRUE(model::HandModel::parse(urdf, toml("human = 'ring'\n")));
}

}  // namespace
}  // namespace prehend::mapping
