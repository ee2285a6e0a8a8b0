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
      {"[[object]]\nname = \"Cup\"\nX_WO = [1e300,0,0.05,1,0,0,0]\n", "more than 5 m away"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,0.05,1,0,0,0]\n"
       "[[object]]\nname = \"Cup\"\nX_WO = [1,0,0.05,1,0,0,0]\n",
       "two objects are named 'Cup'"},
      {"[[object]]\nname = \"Cup\"\nX_WO = [0,0,0.05,1,0,0,0]\n"
       "[[object]]\nname = \"Talc\"\nX_WO = [0.01,0,0.05,1,0,0,0]\n",
       "line 4: objects 'Cup' and 'Talc' are inside each other"},
      // Neither middle is in the other.
      {"[[object]]\nname = \"Vitamins\"\nX_WO = [0,0,0.08,1,0,0,0]\n"
       "[[object]]\nname = \"Talc\"\nX_WO = [0.02,0,0.18,1,0,0,0]\n",
       "inside each other"},
      {"[scene]\nname = 3\n", "line 2: scene.name has the wrong type"},
      {"\n[[object]]\nname = \"\\u001b[2J\"\nX_WO = [0,0,0,1,0,0,0]\n",
       "line 2: object '\\x1b[2J'"},
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

TEST(Scene, WhatStandsBesideOrOnAnotherIsNotInsideIt) {
  const std::string cube = "[[object]]\nname = \"Wood cube\"\nX_WO = [0,0,0.0215,1,0,0,0]\n";
  for (const char* cup : {"0.0545,0,0.0465", "0,0,0.0895"}) {
    const auto scene = load_scene(
        write(cube + "[[object]]\nname = \"Cup\"\nX_WO = [" + cup + ",1,0,0,0]\n"), catalogue());
    EXPECT_TRUE(scene) << scene.error().message();
  }
}

TEST(Catalogue, BadObjectsAreNamedWithTheirLine) {
  const auto object = [](const std::string& shape, const std::string& size,
                         const std::string& more = "mass = 0.1\n") {
    return "[[object]]\nname = \"A\"\nshape = \"" + shape + "\"\nsize = " + size +
           "\nmaterial = \"wood\"\n" + more;
  };
  const std::string sound = object("cylinder", "[0.03, 0.03, 0.1]");
  EXPECT_TRUE(Catalogue::load(write(sound)));
  EXPECT_TRUE(Catalogue::load(write(object("cone", "[0.03, 0.05, 0.1]"))));
  for (const auto& [text, expected] : {
           std::pair(object("cylinder", "[0.03, 0.05, 0.1]"),
                     "line 1: object 1: a cylinder has one radius"),
           std::pair(object("sphere", "[0.03, 0.03, 0.1]"), "a sphere has one radius"),
           std::pair("\n" + object("box", "[30, 50, 100]"), "line 2: object 1: its size is beyond"),
           std::pair(object("box", "[1, 1, 1]", "mass = 1e300\n"), "its mass is beyond"),
           std::pair(object("box", "[1, 1, 1]", "mass = 1\nappearance = {colours = [[9, 9, 9]]}\n"),
                     "a colour needs"),
           std::pair(sound + sound, "line 7: two objects named A"),
           std::pair(std::string(), "has no [[object]]"),
           std::pair(std::string("object = [3]"), "object is no table (write [[object]])"),
           std::pair(std::string("[[object]]"), "object 1: needs a name of 1 to 64 bytes"),
           std::pair(object("ball", "[1, 1, 1]"), "shape is no cylinder, box, sphere or cone"),
           std::pair(object("unknown", "[1, 1, 1]"), "shape is no cylinder, box, sphere or cone"),
           std::pair(object("box", "[1, 1]"), "size needs three numbers in metres"),
           std::pair(object("box", "[1, 1, 0]"), "sizes must be positive"),
           std::pair(object("box", "[1, 1, 1]", "mass = 0\n"), "mass must be positive, in kg"),
           std::pair(object("box", "[1, 1, 1]", "mesh = 3\n"), "mesh needs the name of a file"),
           std::pair(
               std::string("[[object]]\nname = \"A\"\nshape = \"box\"\nsize = [1, 1, 1]\nmass = 1"),
               "needs a material"),
       }) {
    const auto read = Catalogue::load(write(text));
    ASSERT_FALSE(read) << text;
    EXPECT_NE(read.error().message().find(expected), std::string::npos) << read.error().message();
  }
}

}  // namespace
}  // namespace prehend::model
