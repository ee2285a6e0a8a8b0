// The synthetic camera draws what the calibration says: objects where they project to, shadows away
// from the lamp, and the same picture for the same scene.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "services/recognition/core/geometry/silhouette.hpp"
#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

double brightness(const Picture& picture, const Eigen::Vector2d& pixel) {
  double sum = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const auto* p =
          picture.at(static_cast<int>(pixel.x()) + dx, static_cast<int>(pixel.y()) + dy);
      sum += p[0] + p[1] + p[2];
    }
  return sum / 75;
}

/// The catalogue's, and a cup, a tent and a flat funnel.
std::vector<model::CatalogueObject> objects_of_all_shapes() {
  auto made = catalogue().objects();
  for (const Eigen::Vector3d& size :
       {Eigen::Vector3d(0.025, 0.04, 0.1), Eigen::Vector3d(0.06, 0, 0.1), {0.02, 0.07, 0.03}}) {
    made.push_back(made.front());
    made.back().name = fmt::format("cone {}", made.size());
    made.back().shape = {model::ShapeKind::cone, size};
  }
  made.push_back(made.front());
  made.back().name = "ball";
  made.back().shape = {model::ShapeKind::sphere, Eigen::Vector3d::Constant(0.04)};
  return made;
}

TEST(Renderer, ObjectsCoverTheirSilhouettes) {
  const auto objects = objects_of_all_shapes();
  const Renderer all(objects);
  for (const auto& object : objects) {
    model::Scene scene;
    const TablePose at{0.05, 0.03, 0.5};
    scene.objects.push_back({object.name, standing_pose(object.shape, at)});
    const Plane mask = all.mask(scene, 0, lab_camera());
    const auto region = silhouette(lab_camera(), object.shape, at);
    ASSERT_TRUE(region);
    int covered = 0, both = 0;
    for (const auto value : mask.values) covered += value;
    for (std::size_t i = 0; i < region->rows.size(); ++i)
      for (int x = region->rows[i].left; x < region->rows[i].right; ++x)
        both += mask.at(x, region->top + static_cast<int>(i));
    // Cylinders are polygons of twenty corners in the silhouette: two in a hundred.
    EXPECT_GT(both, 0.97 * covered) << object.name;
    EXPECT_GT(both, 0.97 * region->area()) << object.name;
  }
}

// A change of the lens that moved the picture by a third of a pixel went unnoticed.
TEST(Renderer, TheLensBlursToBothSidesAlike) {
  model::CatalogueObject white;
  white.name = "white";
  white.shape = {model::ShapeKind::box, {0.1, 0.1, 0.1}};
  white.material = "plastic";
  white.appearance = {{{1, 1, 1}}, "plain", 1};
  model::Scene scene;
  scene.table_colour.setZero();
  scene.light.to_light_W = Eigen::Vector3d(0, -1, 1).normalized();
  scene.objects.push_back({"white", make_pose({0, 0, 0.05})});
  CameraModel camera = lab_camera();
  camera.centre.x() = 0.5 * (camera.width - 1);
  const Picture picture = Renderer({white}).render_still(scene, camera, {});
  const int y = static_cast<int>(camera.project({0, -0.05, 0.05})->y());
  const auto at = [&](int x) {
    const auto* rgb = picture.at(x, y);
    return (rgb[0] + rgb[1] + rgb[2]) / 3.0;
  };
  const int middle = camera.width / 2;
  ASSERT_GT(at(middle), 150);
  for (int x = 0; x < middle; ++x)
    EXPECT_NEAR(at(x), at(camera.width - 1 - x), 0.1 * at(middle)) << x;
}

TEST(Renderer, ShadowFallsAwayFromTheLamp) {
  model::Scene scene;
  scene.light.to_light_W = Eigen::Vector3d(1, 0, 1).normalized();
  scene.objects.push_back({"Cup", make_pose({0, 0, 0.0465})});
  const Picture picture = renderer().render(scene, lab_camera());
  const double dark = brightness(picture, *lab_camera().project({-0.07, 0, 0}));
  const double bright = brightness(picture, *lab_camera().project({0.07, 0, 0}));
  EXPECT_LT(dark, 0.85 * bright);
}

TEST(Renderer, SameSceneSamePictureOtherNoiseOtherPicture) {
  const model::Scene scene = *model::make_scene(catalogue(), 7, {});
  RenderOptions options;
  const Picture a = renderer().render(scene, lab_camera(), options);
  EXPECT_EQ(a.rgb, renderer().render(scene, lab_camera(), options).rgb);
  options.noise_seed = 2;
  EXPECT_NE(a.rgb, renderer().render(scene, lab_camera(), options).rgb);
}

TEST(Renderer, NoiseHasTheSpreadAsked) {
  Picture grey(200, 200);
  std::fill(grey.rgb.begin(), grey.rgb.end(), std::uint8_t{128});
  Renderer::add_noise(grey, 3.0, 9);
  double sum = 0, squares = 0;
  for (const auto v : grey.rgb) sum += v, squares += double(v) * v;
  const double mean = sum / static_cast<double>(grey.rgb.size());
  EXPECT_NEAR(mean, 128, 0.1);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(grey.rgb.size()) - mean * mean), 3, 0.15);
}

TEST(Renderer, ObjectsLookDifferent) {
  // Mean colours of the painted sides differ by more than the light's change of colour would.
  for (const auto& a : catalogue().objects())
    for (const auto& b : catalogue().objects()) {
      if (a.name >= b.name) continue;
      const auto mean = [](const model::CatalogueObject& object) {
        const Face face = paint(object).faces[0];
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (const auto& texel : face.albedo) sum += texel;
        return Eigen::Vector3f(sum / static_cast<float>(face.albedo.size()));
      };
      EXPECT_GT((mean(a) - mean(b)).norm(), 0.05) << a.name << " and " << b.name;
    }
}

}  // namespace
}  // namespace prehend::recognition
