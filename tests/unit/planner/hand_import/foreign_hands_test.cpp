// Two hands as they come from elsewhere become hands of the lab. Expected tips and signs follow
// from how the hands were made (made_hands.cpp); 2 mm is the slice of a link's end whose middle is
// its tip.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "services/planner/tools/hand_import/make_hand.hpp"
#include "tests/unit/planner/hand_import/made_hands.hpp"

namespace {

using namespace prehend;
using Eigen::Vector3d;

Expected<planner::MadeHand> made(const std::string& urdf) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "made_hands" / "urdf";
  std::filesystem::create_directories(folder);
  std::ofstream(folder.parent_path() / "palm.obj") << made_hands::palm_mesh();
  const auto robot = planner::read_robot(urdf);
  if (!robot) return tl::unexpected(robot.error());
  return planner::make_hand(*robot, "foreign", planner::mesh_files(folder / "robot.urdf"));
}

const model::HandDof& dof(const model::HandModel& hand, const std::string& name) {
  for (const model::HandDof& d : hand.dofs())
    if (d.name == name) return d;
  throw std::runtime_error("no DoF " + name);
}

TEST(ForeignHand, GripperWithMeshAndFixedPads) {
  const auto hand = made(made_hands::gripper());
  ASSERT_TRUE(hand) << hand.error().message();
  const model::HandModel& model = hand->model;
  ASSERT_EQ(model.links().size(), 3u);  // mount and body are one, as are fingers and pads
  ASSERT_EQ(model.dofs().size(), 1u);
  EXPECT_EQ(model.dofs()[0].closing, -1);
  EXPECT_EQ(model.postures().at("open")[0], 0.04);  // it rests closed
  ASSERT_EQ(model.links()[0].collision.size(), 1u);
  const model::CollisionShape& palm = model.links()[0].collision[0];
  EXPECT_EQ(palm.shape.kind, model::ShapeKind::box);
  EXPECT_LT((palm.X_LS.linear().cwiseAbs() * palm.shape.size - Vector3d(0.06, 0.1, 0.04)).norm(),
            1e-6);  // assimp reads floats
  EXPECT_LT((palm.X_LS.translation() - Vector3d(0, 0, 0.03)).norm(), 1e-9);
  ASSERT_EQ(model.fingertips().size(), 2u);
  const auto tips = model.fingertip_positions(Eigen::VectorXd::Constant(1, 0.04));
  for (const Vector3d& tip : tips) EXPECT_NEAR(tip.z(), 0.03 + 0.02 + 0.03 + 0.03, 0.002);
  EXPECT_NEAR((tips[0] - tips[1]).norm(), 2 * (0.04 + 0.009 - 0.004), 0.002);
  EXPECT_GT(model.X_BG().linear().col(2).z(), 0.99);
  EXPECT_GT(std::abs(model.X_BG().linear().col(1).y()), 0.99);
  EXPECT_TRUE(hand->opposed);
}

TEST(ForeignHand, FourFingersWithoutCollisionOrLimits) {
  const auto hand = made(made_hands::four_fingers());
  ASSERT_TRUE(hand) << hand.error().message();
  const model::HandModel& model = hand->model;
  ASSERT_EQ(model.fingertips().size(), 4u);
  for (const model::HandFingertip& tip : model.fingertips())
    EXPECT_LT((tip.p_LT - Vector3d(0, 0, 0.04)).norm(), 0.002) << tip.name;
  ASSERT_EQ(model.dofs().size(), 5u);
  for (const char* finger : {"index", "middle", "ring"})
    EXPECT_EQ(dof(model, std::string(finger) + "_base").closing, 1);
  EXPECT_EQ(dof(model, "thumb_base").closing, 1);
  EXPECT_EQ(dof(model, "thumb_bend").closing, 1);
  EXPECT_GT(model.X_BG().linear().col(2).z(), 0.9);
  EXPECT_EQ(dof(model, "thumb_base").lower, -std::numbers::pi);
  for (const model::HandLink& link : model.links()) {
    EXPECT_GT(link.mass, 0) << link.name;
    EXPECT_FALSE(link.collision.empty()) << link.name;
  }
  // Each change is told.
  EXPECT_NE(
      std::find(hand->changes.begin(), hand->changes.end(), "link index_1: collides as it looks"),
      hand->changes.end());
  EXPECT_NE(std::find(hand->changes.begin(), hand->changes.end(),
                      "link thumb_tip: joined to link thumb_2"),
            hand->changes.end());
}

// A solid ball, a round bar and a brick, as points: the primitive of least volume is the one.
TEST(ForeignHand, MeshesBecomeTheNearestPrimitive) {
  std::vector<Vector3d> ball, bar, brick;
  for (int i = 0; i < 60; ++i)
    for (int k = 0; k <= 30; ++k) {
      const double a = i * std::numbers::pi / 30, b = k * std::numbers::pi / 30;
      const Vector3d unit(std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b));
      ball.push_back(Vector3d(0.1, 0, 0) + 0.02 * unit);
      bar.push_back(Vector3d(0.01 * std::cos(a), 0.08 * k / 30, 0.01 * std::sin(a)));
    }
  for (const double x : {0.0, 0.03})
    for (const double y : {0.0, 0.05})
      for (const double z : {0.0, 0.02}) brick.emplace_back(x, y, z);
  const auto sphere = planner::fit_primitive(ball);
  EXPECT_EQ(sphere.shape.kind, model::ShapeKind::sphere);
  EXPECT_NEAR(sphere.shape.size.x(), 0.02, 1e-4);
  const auto cylinder = planner::fit_primitive(bar);
  EXPECT_EQ(cylinder.shape.kind, model::ShapeKind::cylinder);
  EXPECT_NEAR(cylinder.shape.size.x(), 0.01, 1e-4);
  EXPECT_NEAR(cylinder.shape.size.z(), 0.08, 1e-9);
  EXPECT_LT((cylinder.X_LS.translation() - Vector3d(0, 0.04, 0)).norm(), 1e-4);
  const auto box = planner::fit_primitive(brick);
  EXPECT_EQ(box.shape.kind, model::ShapeKind::box);
  EXPECT_NEAR(box.shape.size.prod(), 0.03 * 0.05 * 0.02, 1e-12);
}

}  // namespace
