// The mirror image of a hand is that hand in a mirror: S p of every point p with the reflection
// S = diag(-1, 1, 1), in all its frames, at the same joint values. Sums in another order round
// otherwise, by some 1e-16 m a joint; 1e-12 m is far more than that and far less than any mistake.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/base/random.hpp"
#include "common/model/hand_model.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::VectorXd;

const Eigen::Matrix3d S = Vector3d(-1, 1, 1).asDiagonal();
constexpr double tolerance = 1e-12;

Matrix4d in_mirror(const Pose& X) {
  const Matrix4d S4 = Eigen::Vector4d(-1, 1, 1, 1).asDiagonal();
  return S4 * X.matrix() * S4;
}

class Mirror : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand = test::hand(GetParam());
  const model::HandModel mirror = hand.mirrored();
  Random random{1};

  Vector3d random_point() {
    return {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
  }
  VectorXd random_dof() {
    VectorXd dof(static_cast<Eigen::Index>(hand.dofs().size()));
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
      dof[i] = random.uniform(limits.lower, limits.upper);
    }
    return dof;
  }
};

TEST_P(Mirror, MovesAsTheHandInAMirror) {
  for (int trial = 0; trial < 100; ++trial) {
    const VectorXd dof = random_dof();
    const VectorXd joint = hand.joint_angles(dof);
    ASSERT_EQ(mirror.joint_angles(dof), joint);
    const auto X_BL = hand.link_poses(joint), X_BL_mirror = mirror.link_poses(joint);
    ASSERT_EQ(X_BL_mirror.size(), X_BL.size());
    for (std::size_t i = 0; i < X_BL.size(); ++i)
      EXPECT_LT((X_BL_mirror[i].matrix() - in_mirror(X_BL[i])).norm(), tolerance);
    const auto tips = hand.fingertip_positions(dof), mirrored = mirror.fingertip_positions(dof);
    ASSERT_EQ(mirrored.size(), tips.size());
    for (std::size_t i = 0; i < tips.size(); ++i)
      EXPECT_LT((mirrored[i] - S * tips[i]).norm(), tolerance);
  }
  EXPECT_LT((mirror.X_BG().matrix() - in_mirror(hand.X_BG())).norm(), tolerance);
}

TEST_P(Mirror, WeighsTheSameAndHasTheShapeOfTheMirrorImage) {
  ASSERT_EQ(mirror.links().size(), hand.links().size());
  for (std::size_t i = 0; i < hand.links().size(); ++i) {
    const model::HandLink &link = hand.links()[i], &other = mirror.links()[i];
    EXPECT_EQ(other.mass, link.mass);
    EXPECT_EQ(other.com_L, S * link.com_L);
    const Vector3d turning = random_point();
    EXPECT_NEAR((S * turning).dot(other.inertia_L * (S * turning)),
                turning.dot(link.inertia_L * turning), tolerance);
    ASSERT_EQ(other.collision.size(), link.collision.size());
    for (std::size_t k = 0; k < link.collision.size(); ++k) {
      const model::CollisionShape &part = link.collision[k], &image = other.collision[k];
      EXPECT_GT(image.X_LS.linear().determinant(), 0.999) << "no rotation";
      for (int trial = 0; trial < 20; ++trial) {
        const Vector3d p_L = random_point();
        EXPECT_NEAR(model::signed_distance(image.shape, image.X_LS.inverse() * (S * p_L)),
                    model::signed_distance(part.shape, part.X_LS.inverse() * p_L), tolerance);
      }
    }
  }
}

TEST_P(Mirror, OfTheMirrorImageIsTheHandToTheBit) {
  const model::HandModel twice = mirror.mirrored();
  EXPECT_EQ(mirror.name(), hand.name() + "_left");
  EXPECT_EQ(twice.name(), hand.name());
  for (std::size_t i = 0; i < hand.links().size(); ++i) {
    const model::HandLink &link = hand.links()[i], &other = twice.links()[i];
    EXPECT_EQ(other.com_L, link.com_L);
    EXPECT_EQ(other.inertia_L, link.inertia_L);
    for (std::size_t k = 0; k < link.collision.size(); ++k)
      EXPECT_EQ(other.collision[k].X_LS.matrix(), link.collision[k].X_LS.matrix());
  }
  for (std::size_t i = 0; i < hand.joints().size(); ++i) {
    EXPECT_EQ(twice.joints()[i].X_PJ.matrix(), hand.joints()[i].X_PJ.matrix());
    EXPECT_EQ(twice.joints()[i].axis_J, hand.joints()[i].axis_J);
  }
  for (std::size_t i = 0; i < hand.fingertips().size(); ++i)
    EXPECT_EQ(twice.fingertips()[i].p_LT, hand.fingertips()[i].p_LT);
  EXPECT_EQ(twice.X_BG().matrix(), hand.X_BG().matrix());
}

TEST_P(Mirror, IsFoundByItsName) {
  const std::string name = GetParam() + "_left";
  const auto folder = model::hand_directory(name);
  EXPECT_TRUE(model::is_hand(folder));
  EXPECT_EQ(model::named_hand(name).value(), folder);
  const auto loaded = model::HandModel::load(folder);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->name(), name);
  const VectorXd open = hand.postures().at("open");
  EXPECT_EQ(loaded->postures().at("open"), open);
  EXPECT_EQ(loaded->fingertip_positions(open), mirror.fingertip_positions(open));
  EXPECT_FALSE(model::is_hand(model::hand_directory(GetParam() + "_right")));
  EXPECT_FALSE(model::named_hand(GetParam() + "_right"));
}

INSTANTIATE_TEST_SUITE_P(Models, Mirror, testing::ValuesIn(test::hand_names()),
                         [](const auto& hand) { return hand.param; });

/// Folders of hands that are copies of one of ours.
class MirrorPlaces : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  void keep(const std::string& name) const {
    const auto from = model::hand_directory("parallel_jaw");
    std::filesystem::create_directories(folder / name);
    std::filesystem::copy(from / "hand.urdf", folder / name / "hand.urdf");
    std::ifstream read(from / "hand.toml");
    std::ofstream write(folder / name / "hand.toml");
    for (std::string line; std::getline(read, line);)
      write << (line.starts_with("name = \"parallel_jaw\"") ? "name = \"" + name + "\"" : line)
            << "\n";
  }
  std::string loaded(const std::string& name) const {
    const auto hand = model::HandModel::load(folder / name);
    return hand ? hand->name() : hand.error().message();
  }

  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("prehend_mirror_" + std::to_string(getpid()));
};

TEST_F(MirrorPlaces, WhatIsPublishedAsLeftHasARightMirrorImage) {
  keep("grip_left");
  EXPECT_EQ(loaded("grip_left"), "grip_left");
  EXPECT_EQ(loaded("grip_right"), "grip_right");
  EXPECT_EQ(model::hand_files(folder / "grip_right"), folder / "grip_left");
  EXPECT_FALSE(model::is_hand(folder / "grip"));
}

TEST_F(MirrorPlaces, FilesOfItsOwnComeFirst) {
  keep("grip");
  EXPECT_EQ(model::hand_files(folder / "grip_left"), folder / "grip");
  EXPECT_EQ(model::hand_files(folder / "grip_left" / ""), folder / "grip");
  keep("grip_left");
  EXPECT_EQ(model::hand_files(folder / "grip_left"), folder / "grip_left");
  EXPECT_EQ(model::hand_files(folder / "grip_left_left"), folder / "grip_left");
  EXPECT_EQ(model::hand_files(folder / "_left"), folder / "_left");
}

}  // namespace
