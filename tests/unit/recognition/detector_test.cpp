// Scenes drawn by the lab's own scene maker, which training has never seen: right names, and places
// within what a hand needs. Median 1 cm and never 2 cm are the requirements; the renderer has no
// lens error, so a regression shows long before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

const Detector& detector() {
  static const Detector made(trained(), catalogue());
  return made;
}

model::Scene empty_table(std::uint64_t seed) {
  model::Scene scene = *model::make_scene(catalogue(), seed, {});
  scene.objects.clear();
  return scene;
}

const Sighting* find(const std::vector<Sighting>& found, const std::string& name) {
  for (const Sighting& sighting : found)
    if (sighting.name == name) return &sighting;
  return nullptr;
}

double turn_error(const model::Shape& shape, double a, double b) {
  const bool square = std::abs(shape.size.x() - shape.size.y()) < 1e-3;
  return std::abs(std::remainder(a - b, square ? std::numbers::pi / 2 : std::numbers::pi));
}

TEST(Detector, FindsTheTargetOfEveryScene) {
  std::vector<double> errors;
  for (std::uint64_t seed = 1000; seed < 1018; ++seed) {
    model::SceneOptions options;
    options.target = catalogue().objects()[seed % 9].name;
    const model::Scene scene = *model::make_scene(catalogue(), seed, options);
    const auto found = *detector().on_table(renderer().render(scene, lab_camera()), lab_camera());
    const model::PlacedObject& target = scene.objects.front();
    const Sighting* seen = find(found, target.name);
    ASSERT_TRUE(seen) << target.name << ", seed " << seed;
    ASSERT_TRUE(seen->at);
    const Eigen::Vector3d p = target.X_WO.translation();
    errors.push_back(std::hypot(seen->at->x - p.x(), seen->at->y - p.y()));
    EXPECT_LT(errors.back(), 0.01) << target.name << ", seed " << seed;
    if (seen->shape.kind == model::ShapeKind::box) {
      const Eigen::Matrix3d R = target.X_WO.linear();
      EXPECT_LT(turn_error(seen->shape, std::atan2(R(1, 0), R(0, 0)), seen->at->yaw),
                8 * std::numbers::pi / 180)
          << target.name << ", seed " << seed;
    }
    EXPECT_GT(seen->probability, 0.5);
    for (const Sighting& sighting : found)
      EXPECT_TRUE(std::any_of(scene.objects.begin(), scene.objects.end(),
                              [&](const auto& placed) { return placed.name == sighting.name; }))
          << "saw " << sighting.name << " that is not there, seed " << seed;
  }
  std::nth_element(errors.begin(), errors.begin() + 9, errors.end());
  EXPECT_LT(errors[9], 0.004);
}

TEST(Detector, EmptyTableShowsNothing) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto found =
        *detector().on_table(renderer().render(empty_table(seed), lab_camera()), lab_camera());
    EXPECT_TRUE(found.empty()) << found.front().name << ", seed " << seed;
  }
}

TEST(Detector, ShadowDoesNotPullTheObject) {
  for (const double azimuth : {0.0, 1.6, 3.1, 4.7}) {
    model::Scene scene = empty_table(3);
    scene.table_colour = {0.55, 0.55, 0.55};
    scene.light.to_light_W =
        Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.7).normalized();
    scene.light.ambient = 0.3;  // dark shadows
    scene.objects.push_back({"Cup", make_pose({0.05, 0.02, 0.0465})});
    const auto found = *detector().on_table(renderer().render(scene, lab_camera()), lab_camera());
    const Sighting* cup = find(found, "Cup");
    ASSERT_TRUE(cup) << azimuth;
    EXPECT_LT(std::hypot(cup->at->x - 0.05, cup->at->y - 0.02), 0.01) << azimuth;
  }
}

// A lamp behind a box throws a strip of shadow towards the camera that once passed for the box'
// foot.
TEST(Detector, ShadowInFrontIsNoFoot) {
  const model::Scene scene = *model::make_scene(catalogue(), 201, {});
  for (const model::PlacedObject& placed : scene.objects) {
    const auto found = *detector().on_table(renderer().render(scene, lab_camera()), lab_camera());
    const Sighting* seen = find(found, placed.name);
    ASSERT_TRUE(seen) << placed.name;
    const Eigen::Vector3d p = placed.X_WO.translation();
    EXPECT_LT(std::hypot(seen->at->x - p.x(), seen->at->y - p.y()), 0.01) << placed.name;
  }
}

TEST(Detector, AStrangerIsNotSureToBeOneOfOurs) {
  // A model without the Cup sees the Cup.
  std::vector<TrainingClass> classes;
  for (const auto& object : catalogue().objects())
    if (object.name != "Cup")
      classes.push_back({object.name, training_views(renderer(), object, CameraModel{}, 16, 6)});
  const Detector without(*train(classes), catalogue());
  model::Scene scene = empty_table(8);
  scene.objects.push_back({"Cup", make_pose({0.0, 0.0, 0.0465})});
  const auto found = *without.on_table(renderer().render(scene, lab_camera()), lab_camera());
  for (const Sighting& s : found) EXPECT_LT(s.probability, 0.7) << s.name;
}

TEST(Detector, SamePictureSameAnswer) {
  const model::Scene scene = *model::make_scene(catalogue(), 42, {});
  const Picture picture = renderer().render(scene, lab_camera());
  const auto a = *detector().on_table(picture, lab_camera());
  const auto b = *detector().on_table(picture, lab_camera());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].at->x, b[i].at->x);
    EXPECT_EQ(a[i].probability, b[i].probability);
  }
}

TEST(Detector, OddPicturesAreRefusedOrEmpty) {
  EXPECT_FALSE(detector().on_table(Picture(64, 48), lab_camera()));
  CameraModel camera = lab_camera();
  EXPECT_TRUE(detector().on_table(Picture(camera.width, camera.height), camera)->empty());
  EXPECT_TRUE(detector().in_picture(Picture()).empty());
  EXPECT_TRUE(detector().in_picture(Picture(1, 1)).empty());
  EXPECT_TRUE(detector().in_picture(Picture(9, 300)).empty());
}

TEST(Training, UnseenViewsAreNamedRightly) {
  int right = 0, all = 0;
  for (const auto& object : catalogue().objects())
    for (const TrainingView& view : training_views(renderer(), object, CameraModel{}, 6, 99)) {
      const auto seen = classify(
          trained(), describe(trained(), trained().palette.quantise(view.picture), view.mask));
      ++all;
      right += trained().classes[static_cast<std::size_t>(seen.best)].name == object.name;
    }
  EXPECT_GE(right, all - 1) << "of " << all;
}

TEST(Training, WithoutAViewFails) {
  EXPECT_FALSE(train(std::vector<TrainingClass>()));
  EXPECT_FALSE(train(std::vector<TrainingClass>(1, TrainingClass{"empty", {}})));
}

TEST(Training, OneClassWithOnePictureWorks) {
  const auto views = training_views(renderer(), catalogue().objects()[2], CameraModel{}, 1, 1);
  const auto models = train(std::vector<TrainingClass>(1, TrainingClass{"Cup", views}));
  ASSERT_TRUE(models);
  EXPECT_TRUE(models->check());
}

}  // namespace
}  // namespace prehend::recognition
