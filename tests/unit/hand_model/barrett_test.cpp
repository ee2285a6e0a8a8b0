// The Barrett hand's forward kinematics against its table of Denavit-Hartenberg parameters,
// computed here by itself, and against link frames that GraspIt! printed for one posture. Tolerance
// 1e-9 m: double precision through at most five transforms of decimetres leaves 1e-16; the rest is
// for the decimal digits of the URDF.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "common/base/random.hpp"
#include "common/model/hand_model.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace prehend;
using Eigen::AngleAxisd;
using Eigen::Translation3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double degree = std::numbers::pi / 180;

std::filesystem::path models() {
  return std::filesystem::path(test::in_sources("common/models"));
}

model::HandModel barrett() {
  auto hand = model::HandModel::load(models() / "hands/barrett");
  if (!hand) throw std::runtime_error(hand.error().message());
  return *hand;
}

Pose dh(double theta, double a, double alpha) {
  return Pose(AngleAxisd(theta, Vector3d::UnitZ())) * Translation3d(a, 0, 0) *
         AngleAxisd(alpha, Vector3d::UnitX());
}

/// Link frames after each joint by the table; in the order finger 1, 2, 3.
std::vector<Pose> by_table(const VectorXd& d) {
  const double quarter = std::numbers::pi / 2;
  const Pose base1 =
      Pose(Translation3d(0.025, 0, -0.001)) * AngleAxisd(2 * quarter, Vector3d::UnitY());
  const Pose base2 = Pose(Translation3d(-0.025, 0, -0.001));
  const Pose base3 = Pose(Translation3d(0, -0.05, -0.001)) *
                     AngleAxisd(-quarter, Vector3d::UnitY()) *
                     AngleAxisd(-quarter, Vector3d::UnitZ());
  std::vector<Pose> frames;
  const auto finger = [&](Pose X, double flexion) {
    frames.push_back(X = X * dh(flexion + 5 * degree, 0.070, 0));
    frames.push_back(X = X * dh(flexion / 3 + 40 * degree, 0.055, 0));
  };
  frames.push_back(base1 * dh(d[0] + quarter, 0.050, -quarter));
  finger(frames.back(), d[1]);
  frames.push_back(base2 * dh(d[0] + quarter, 0.050, quarter));
  finger(frames.back(), d[2]);
  finger(base3, d[3]);
  return frames;
}

/// The same frames from the model, whose links are placed at their joint instead of after it.
std::vector<Pose> by_model(const model::HandModel& hand, const VectorXd& d) {
  const double quarter = std::numbers::pi / 2;
  const std::vector<Pose> X_BL = hand.link_poses(hand.joint_angles(d));
  std::vector<Pose> frames;
  for (const auto& [name, a, alpha] :
       std::initializer_list<std::tuple<const char*, double, double>>{
           {"f1_spread", 0.050, -quarter},
           {"f1_inner", 0.070, 0},
           {"f1_outer", 0.055, 0},
           {"f2_spread", 0.050, quarter},
           {"f2_inner", 0.070, 0},
           {"f2_outer", 0.055, 0},
           {"f3_inner", 0.070, 0},
           {"f3_outer", 0.055, 0}})
    for (std::size_t i = 0; i < hand.links().size(); ++i)
      if (hand.links()[i].name == name) frames.push_back(X_BL[i] * dh(0, a, alpha));
  return frames;
}

TEST(Barrett, EqualsItsTableEverywhere) {
  const model::HandModel hand = barrett();
  ASSERT_EQ(hand.dofs().size(), 4u);
  ASSERT_EQ(hand.joints().size(), 8u);
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    VectorXd d(4);
    for (Eigen::Index i = 0; i < 4; ++i)
      d[i] = random.uniform(hand.dofs()[i].lower, hand.dofs()[i].upper);
    const auto expected = by_table(d), actual = by_model(hand, d);
    ASSERT_EQ(expected.size(), actual.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      ASSERT_LT((expected[i].matrix() - actual[i].matrix()).cwiseAbs().maxCoeff(), 1e-9)
          << "frame " << i << " at " << d.transpose();
    const auto tips = hand.fingertip_positions(d);
    ASSERT_EQ(tips.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
      ASSERT_LT((tips[i] - expected[i == 2 ? 7 : 3 * i + 2].translation()).norm(), 1e-9);
  }
}

TEST(Barrett, EqualsFramesThatGraspItPrinted) {
  const std::filesystem::path folder = shared_data() / "graspit_contacts";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is not there";
  const model::HandModel hand = barrett();
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path());
    std::string line;
    VectorXd d(4);
    while (std::getline(file, line)) {
      double q[4], t[3];
      int finger = 0, link = 0;
      if (std::sscanf(line.c_str(), "DOF %lf %lf %lf %lf", &d[0], &d[1], &d[2], &d[3]) == 4)
        continue;
      if (std::sscanf(line.c_str(), "LINK %d %d t=%lf %lf %lf q=%lf %lf %lf %lf", &finger, &link, t,
                      t + 1, t + 2, q, q + 1, q + 2, q + 3) != 9)
        continue;
      const auto frames = by_model(hand, d);
      const std::size_t index =
          static_cast<std::size_t>(finger == 2 ? 6 + link : 3 * finger + link);
      // Printed to 1e-4 mm, for DoFs printed to 1e-6 rad that move links of 0.17 m: 2e-7 m.
      EXPECT_LT((frames[index].translation() - Vector3d(t[0], t[1], t[2]) * 1e-3).norm(), 3e-7)
          << line;
      const Eigen::Quaterniond expected(q[0], q[1], q[2], q[3]);
      EXPECT_LT(angle_between(frames[index].linear(), expected.normalized().toRotationMatrix()),
                3e-5)
          << line;
      ++compared;
    }
  }
  EXPECT_GE(compared, 8);
}

TEST(Barrett, CouplesOuterJointsAndClampsDofs) {
  const model::HandModel hand = barrett();
  const VectorXd q = hand.joint_angles(VectorXd::Constant(4, 0.9));
  for (std::size_t i = 0; i < hand.joints().size(); ++i) {
    const bool outer = hand.joints()[i].name.find("outer") != std::string::npos;
    EXPECT_NEAR(q[static_cast<Eigen::Index>(i)], outer ? 0.3 : 0.9, 1e-15) << hand.joints()[i].name;
  }
  EXPECT_EQ(hand.clamp(VectorXd::Constant(4, -1)), VectorXd::Zero(4));
  EXPECT_NEAR(hand.clamp(VectorXd::Constant(4, 9))[1], 144 * degree, 1e-12);
}

}  // namespace
