// Pictures show what they claim to: a ball covers the area that perspective gives it, its lit side
// is the brighter one, and a grasp's picture has pixels of the hand, of the object and of its
// contacts.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "services/planner/tools/picture/class_picture.hpp"
#include "services/planner/tools/picture/grasp_picture.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using model::ShapeKind;

/// From a metre away along x of W, upright.
Viewpoint from_x() {
  Eigen::Matrix3d R;
  R.col(2) = -Vector3d::UnitX();
  R.col(1) = -Vector3d::UnitZ();
  R.col(0) = R.col(1).cross(R.col(2));
  return {make_pose(Vector3d(1, 0, 0), R), 0.4};
}

Drawing ball(double opacity) {
  Drawing drawing;
  drawing.paints = {{{0.9, 0.1, 0.1}, 0, opacity}};
  drawing.triangles = surface_of({ShapeKind::sphere, Vector3d::Constant(0.1)}, Pose::Identity(), 0);
  drawing.floor = -1;
  return drawing;
}

const std::uint8_t* pixel(const Raster& raster, int x, int y) {
  return raster.rgb.data() + 3 * (y * raster.width + x);
}

TEST(Drawing, ABallIsRoundAndAsLargeAsPerspectiveSays) {
  // tan of the half angle: 0.1 / sqrt(1 - 0.01); 300 px a unit at unit distance over 0.4.
  const double radius = 0.1 / std::sqrt(0.99) * 300 / 0.4;
  for (const double opacity : {1.0, 0.4}) {
    const auto count = ball(opacity).coverage(from_x(), 300, 300);
    // 96 corners stand for a circle, pixels are counted whole: 1 %.
    EXPECT_NEAR(count[0], std::numbers::pi * radius * radius, 0.01 * count[0]);
  }
}

TEST(Drawing, TheLampIsAboveAndTheOutlineIsSmooth) {
  const Raster raster = ball(1).draw(from_x(), 120, 120, 3);
  ASSERT_EQ(raster.rgb.size(), 3u * 120 * 120);
  EXPECT_GT(pixel(raster, 60, 42)[0], pixel(raster, 60, 78)[0] + 20);
  EXPECT_GT(pixel(raster, 60, 60)[0], 2 * pixel(raster, 60, 60)[1]);  // red
  EXPECT_GT(pixel(raster, 2, 2)[1], 200);                             // paper
  std::set<int> along_the_edge;
  for (int x = 20; x < 40; ++x) along_the_edge.insert(pixel(raster, x, 60)[1]);
  EXPECT_GT(along_the_edge.size(), 3u);
}

TEST(Drawing, WhatIsBehindSomethingClearShowsThrough) {
  Drawing drawing = ball(0.4);
  drawing.paints.push_back({{0.1, 0.1, 0.9}});
  for (const Triangle& triangle :
       surface_of({ShapeKind::box, Vector3d::Constant(0.06)}, make_pose(Vector3d(-0.3, 0, 0)), 1))
    drawing.triangles.push_back(triangle);
  const auto behind = drawing.coverage(from_x(), 200, 200);
  EXPECT_GT(behind[1], 100);
  drawing.paints[0].opacity = 1;
  EXPECT_EQ(drawing.coverage(from_x(), 200, 200)[1], 0);
}

TEST(GraspPicture, ShowsHandObjectAndContacts) {
  const auto hand = model::HandModel::load(test::in_sources("common/models/hands/barrett"));
  ASSERT_TRUE(hand);
  const grasping::Body talc{
      "Talc", {ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};
  grasping::PlannedGrasp grasp;
  grasp.X_OB = make_pose(Vector3d(0, 0, 0.15),
                         Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).toRotationMatrix());
  grasp.joints = hand->joint_angles(Eigen::VectorXd::Constant(4, 1.0));
  analysis::Contact contact;
  contact.p_OC = Vector3d(0.024, 0, 0);
  contact.normal_O = -Vector3d::UnitX();
  contact.friction = 1;
  grasp.contacts = {contact};
  const auto scene = draw_grasp(*hand, talc, grasp);
  ASSERT_TRUE(scene);
  const Viewpoint view = best_view(*scene, 4.0 / 3);
  const auto seen = scene->drawing.coverage(view, 320, 240);
  const auto pixels = [&](int paint) { return seen[static_cast<std::size_t>(paint)]; };
  EXPECT_GT(pixels(scene->object_paint), 500);
  EXPECT_GT(pixels(scene->cone_paint), 20);
  ASSERT_EQ(scene->hand_paints.size(), 2u);  // plastic palm, rubber fingers
  for (const int paint : scene->hand_paints) EXPECT_GT(pixels(paint), 500);

  const auto file = std::filesystem::path(testing::TempDir()) / "grasp_picture_test.png";
  ASSERT_TRUE(save(file, scene->drawing.draw(view, 160, 120, 1)));
  EXPECT_GT(std::filesystem::file_size(file), 1000u);
  std::filesystem::remove(file);
  EXPECT_FALSE(save("/nowhere/at/all.png", scene->drawing.draw(view, 64, 64, 1)));

  const auto shapeless = draw_grasp(*hand, {"Ghost", {}, 0.15, "plastic", {}}, grasp);
  ASSERT_FALSE(shapeless);
  EXPECT_EQ(shapeless.error().message(), "Ghost: has no valid shape");
  grasp.joints.resize(3);
  EXPECT_FALSE(draw_grasp(*hand, talc, grasp));
}

// Of each of Cutkosky's kinds: hand and object are seen, and no two kinds look the same.
TEST(ClassPicture, EachKindShowsAHandAndWhatItHolds) {
  const auto taxonomy =
      model::GraspTaxonomy::load(test::in_sources("common/models/grasps/taxonomy.toml"));
  ASSERT_TRUE(taxonomy);
  std::set<std::vector<std::uint8_t>> pictures;
  for (const model::GraspClass& kind : taxonomy->classes()) {
    const Drawing drawing = draw_class(kind);
    const Viewpoint view = view_of_class(drawing, 4.0 / 3);
    const std::vector<int> pixels = drawing.coverage(view, 80, 60);
    EXPECT_GT(pixels[class_hand], 400) << kind.name;
    EXPECT_GT(pixels[class_object], 20) << kind.name;
    pictures.insert(drawing.draw(view, 80, 60, 1).rgb);
  }
  EXPECT_EQ(pictures.size(), taxonomy->classes().size());
}

}  // namespace
}  // namespace prehend::planner
