// What moved is told from noise, shadows and light. Noise has a sigma of 2 to 3 grey levels; the
// threshold of 20 is then six sigma of a difference, and a cell has 25 pixels looked at.
#include "services/recognition/core/detection/movement.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

model::Scene table_with_cup(double x) {
  model::Scene scene = *model::make_scene(catalogue(), 3, {});
  scene.objects.clear();
  scene.objects.push_back({"Cup", make_pose({x, 0.02, 0.0465})});
  return scene;
}

Picture shot(const model::Scene& scene, std::uint64_t noise) {
  RenderOptions options;
  options.noise_seed = noise;
  return renderer().render(scene, lab_camera(), options);
}

int cells(const Plane& plane) {
  return static_cast<int>(std::count(plane.values.begin(), plane.values.end(), 1));
}

TEST(Movement, NoiseIsNone) {
  Movement movement;
  EXPECT_EQ(cells(movement.look(shot(table_with_cup(0), 1))), 64 * 48);
  EXPECT_TRUE(movement.all_new());
  for (std::uint64_t noise = 2; noise < 6; ++noise)
    EXPECT_EQ(cells(movement.look(shot(table_with_cup(0), noise))), 0);
  EXPECT_EQ(movement.relearned(), 0);
}

TEST(Movement, WhatMovedDiffersHereAndThereAndNowhereElse) {
  Movement movement;
  movement.look(shot(table_with_cup(-0.1), 1));
  const Plane moved = movement.look(shot(table_with_cup(0.15), 2));
  const auto at = [&](double x, double z) {
    const auto pixel = *lab_camera().project({x, 0.02, z});
    return moved.at(static_cast<int>(pixel.x()) / 10, static_cast<int>(pixel.y()) / 10);
  };
  EXPECT_EQ(at(-0.1, 0.05), 1);
  EXPECT_EQ(at(0.15, 0.05), 1);
  EXPECT_EQ(at(-0.4, 0), 0);
  // Twice the cup, seen at 1.1 m: 37 by 60 px, and the cells that its rim touches.
  EXPECT_LT(cells(moved), 2 * 6 * 9);
}

TEST(Movement, WhatWasLookedAtIsBackground) {
  Movement movement;
  movement.look(shot(table_with_cup(-0.1), 1));
  const Picture second = shot(table_with_cup(0.15), 2);
  const Plane moved = movement.look(second);
  movement.learn(second, moved);
  EXPECT_EQ(cells(movement.look(shot(table_with_cup(0.15), 3))), 0);
  EXPECT_GT(cells(movement.look(shot(table_with_cup(-0.1), 4))), 20);
}

TEST(Movement, ShadowsAreNone) {
  // The same cup, another lamp: its shadow lies elsewhere, the table is as bright as before.
  model::Scene scene = table_with_cup(0);
  scene.table_colour = {0.55, 0.5, 0.45};
  scene.light.to_light_W = Eigen::Vector3d(0.7, 0, 0.7).normalized();
  Picture without = shot(scene, 1);
  Movement movement;
  // A shadow by the book: part of the picture darker by a third, in its own colour.
  movement.look(without);
  Picture with = shot(scene, 2);
  for (int y = 300; y < 400; ++y)
    for (int x = 50; x < 200; ++x)
      for (int c = 0; c < 3; ++c)
        with.at(x, y)[c] = static_cast<std::uint8_t>(with.at(x, y)[c] * 2 / 3);
  EXPECT_EQ(cells(movement.look(with)), 0);
  // The same place in another colour is no shadow.
  for (int y = 300; y < 400; ++y)
    for (int x = 50; x < 200; ++x) with.at(x, y)[2] = 20;
  EXPECT_EQ(cells(movement.look(with)), 15 * 10);
}

TEST(Movement, LightThatChangesForAllIsFollowed) {
  Movement movement;
  model::Scene scene = table_with_cup(0);
  movement.look(shot(scene, 1));
  // Exposure and colour of the lamp drift by a fifth.
  scene.light.gain *= 0.8;
  scene.light.colour = {1.08, 1, 0.93};
  EXPECT_LT(cells(movement.look(shot(scene, 2))), 10);
  EXPECT_EQ(movement.relearned(), 0);
}

TEST(Movement, AnotherPictureIsLearnedAnew) {
  Movement movement;
  movement.look(shot(table_with_cup(0), 1));
  Picture other(640, 480);
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x) other.at(x, y)[(x / 7 + y / 11) % 3] = 200;
  EXPECT_EQ(cells(movement.look(other)), 64 * 48);
  EXPECT_EQ(movement.relearned(), 1);
  EXPECT_EQ(cells(movement.look(other)), 0);
  // Another size starts over, whatever it is.
  for (const auto& [w, h] : {std::pair(33, 17), std::pair(8, 8), std::pair(1281, 723)}) {
    EXPECT_EQ(cells(movement.look(Picture(w, h))), (w + 9) / 10 * ((h + 9) / 10));
    EXPECT_EQ(cells(movement.look(Picture(w, h))), 0);
  }
  movement.look(Picture());
  movement.learn(Picture(640, 480), Plane(64, 48, 1));  // not the last one's size: nothing happens
}

}  // namespace
}  // namespace prehend::recognition
