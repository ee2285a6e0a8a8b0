// Scenes drawn from seeds: they stand on the table, keep clear of one another, differ between
// seeds, repeat for one seed, and survive the way through a file exactly.
#include "common/model/scene.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "tests/support/paths/paths.hpp"

namespace prehend::model {
namespace {

Catalogue catalogue() {
  auto loaded = Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  EXPECT_TRUE(loaded) << loaded.error().message();
  return *loaded;
}

std::filesystem::path write(const std::string& text) {
  const auto file =
      std::filesystem::temp_directory_path() / ("scene-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << text;
  return file;
}

TEST(Scene, DrawnScenesAreSoundAndRepeat) {
  const Catalogue objects = catalogue();
  std::set<std::string> targets;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto scene = make_scene(objects, seed, {});
    ASSERT_TRUE(scene);
    EXPECT_EQ(to_toml(*scene), to_toml(*make_scene(objects, seed, {})));
    ASSERT_FALSE(scene->objects.empty());
    EXPECT_EQ(scene->objects[0].name, scene->demonstrator.target);
    targets.insert(scene->demonstrator.target);
    for (std::size_t i = 0; i < scene->objects.size(); ++i) {
      const auto& a = scene->objects[i];
      const auto half = half_extents(objects.find(a.name)->shape);
      EXPECT_NEAR(a.X_WO.translation().z(), half.z(), 1e-12);
      EXPECT_NEAR(a.X_WO.linear()(2, 2), 1, 1e-12) << "stands upright";
      for (std::size_t j = 0; j < i; ++j) {
        const auto& b = scene->objects[j];
        const auto other = half_extents(objects.find(b.name)->shape);
        EXPECT_GT((a.X_WO.translation() - b.X_WO.translation()).head<2>().norm(),
                  half.head<2>().norm() + (j == 0 ? 0.2 : other.head<2>().norm()));
      }
    }
  }
  EXPECT_EQ(targets.size(), objects.objects().size()) << "every object is drawn some time";
}

TEST(Scene, AFileGivesBackTheSameScene) {
  const Catalogue objects = catalogue();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Scene scene = *make_scene(objects, seed, {});
    scene.demonstrator.reach = {0.09, 0.03, 0.12, 0.07};
    const auto read = load_scene(write(to_toml(scene)), objects);
    ASSERT_TRUE(read) << read.error().message();
    ASSERT_EQ(read->objects.size(), scene.objects.size());
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      EXPECT_EQ(read->objects[i].name, scene.objects[i].name);
      // Rotations pass through quaternions, which costs a digit.
      EXPECT_NEAR((read->objects[i].X_WO.matrix() - scene.objects[i].X_WO.matrix()).norm(), 0,
                  1e-14);
    }
    EXPECT_EQ(read->name, scene.name);
    EXPECT_EQ(read->texture_seed, scene.texture_seed);
    EXPECT_EQ(read->table_colour, scene.table_colour);
    EXPECT_EQ(read->light.ambient, scene.light.ambient);
    EXPECT_NEAR((read->light.to_light_W - scene.light.to_light_W).norm(), 0, 1e-15);
    EXPECT_EQ(read->demonstrator.seed, scene.demonstrator.seed);
    EXPECT_EQ(read->demonstrator.approach_turn, scene.demonstrator.approach_turn);
    EXPECT_EQ(read->demonstrator.hand_scale, scene.demonstrator.hand_scale);
    EXPECT_EQ(read->demonstrator.reach.opening, 0.09);
    EXPECT_EQ(read->demonstrator.reach.engage, 0.03);
    EXPECT_EQ(read->demonstrator.reach.clearance, 0.12);
    EXPECT_EQ(read->demonstrator.reach.half_width, 0.07);
  }
}

TEST(Scene, BadFilesSayWhatIsWrong) {
  const Catalogue objects = catalogue();
  const std::pair<const char*, const char*> cases[] = {
      {"[scene]\ncolor = 3\n", "scene.color is not a key"},
      {"[light]\nambient = \"dark\"\n", "light.ambient has the wrong type"},
      {"[[object]]\nname = \"Unicorn\"\nX_WO = [0,0,0,1,0,0,0]\n", "Unicorn"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,0,0,0,0,0]\n", "zero norm"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,nan,1,0,0,0]\n", "finite"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,-5,1,0,0,0]\n", "below the table"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [1e300,0,0.05,1,0,0,0]\n", "too far"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,0.05,1,0,0,0]\n"
       "[[object]]\nname = \"Cup\"\nX_WO = [1,0,0.05,1,0,0,0]\n",
       "two objects are named 'Cup'"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,0.05,1,0,0,0]\n"
       "[[object]]\nname = \"Talc\"\nX_WO = [0.01,0,0.05,1,0,0,0]\n",
       "inside each other"},
      {"[demonstrator]\ntarget = \"Cup\"\n", "stands nowhere"},
      {"[demonstrator]\nhand_scale = 9\n", "hand_scale"},
      {"[demonstrator]\nreach = [0.1, 0.1]\n", "reach needs four numbers"},
      {"[demonstrator]\nreach = [0.1, 0.1, -1, 0.1]\n", "reach must not be negative"},
      {"[weather]\n", "weather"},
      {"= nonsense", ""},
  };
  for (const auto& [text, expected] : cases) {
    const auto scene = load_scene(write(text), objects);
    ASSERT_FALSE(scene) << text;
    EXPECT_NE(scene.error().message().find(expected), std::string::npos) << scene.error().message();
  }
  EXPECT_FALSE(load_scene("/nowhere/scene.toml", objects));
}

}  // namespace
}  // namespace prehend::model
