// Which two hands are asked for, what is said where that is no pair of hands, and what they carry.
#include <gtest/gtest.h>

#include "common/stage/temporary_folder.hpp"
#include "services/cli/tools/demo/carry_setting.hpp"

namespace prehend::cli {
namespace {

std::string refused(const std::vector<std::string>& entries) {
  const auto read = read_hands(entries);
  return read ? "taken" : read.error().what;
}

TEST(CarryHands, ALeftHandIsTheMirrorImageOfAKnownOne) {
  const auto hands = read_hands({"right:dlr", "left:barrett"});
  ASSERT_TRUE(hands);
  EXPECT_EQ(hands->left, "barrett_left");
  EXPECT_EQ(hands->right, "dlr");
  const auto named = read_hands({"left:barrett_left", "right:barrett"});
  ASSERT_TRUE(named);
  EXPECT_EQ(named->left, "barrett_left");
}

TEST(CarryHands, WhatIsNoPairIsNamed) {
  EXPECT_EQ(refused({"left:barrett"}), "names one hand");
  for (const std::string wrong : {"barrett", "left:", ":barrett", "up:barrett", ""})
    EXPECT_EQ(refused({wrong, "right:barrett"}), "«" + wrong + "» is no hand");
  EXPECT_EQ(refused({"left:barrett", "left:dlr"}), "«left:dlr» is no hand");
  EXPECT_EQ(refused({"left:teapot", "right:barrett"}), "'teapot_left' is no hand");
  EXPECT_EQ(refused({"left:barrett", "right:teapot"}), "'teapot' is no hand");
}

// Who draws it by the same seed, in a process of its own, has the same.
TEST(CarrySetting, IsWhatItsFilesSay) {
  const auto folder = stage::TemporaryFolder::create(false);
  ASSERT_TRUE(folder);
  const auto catalogue_file = folder->path() / "catalogue.toml";
  const auto scene_file = folder->path() / "scene.toml";
  for (const CarryTask task : {CarryTask::carry, CarryTask::hand_over}) {
    const auto setting = make_carry_setting(task, 3, "barrett");
    ASSERT_TRUE(setting) << setting.error().message();
    ASSERT_TRUE(write_carry_setting(*setting, catalogue_file, scene_file));
    const auto catalogue = model::Catalogue::load(catalogue_file);
    ASSERT_TRUE(catalogue) << catalogue.error().message();
    const auto scene = model::load_scene(scene_file, *catalogue);
    ASSERT_TRUE(scene) << scene.error().message();
    const model::Demonstrator& person = scene->demonstrator;
    ASSERT_EQ(person.target, setting->object.name);
    EXPECT_EQ(person.hands_over, task == CarryTask::hand_over);
    EXPECT_GT(person.carry_W.norm(), 0.1);
    EXPECT_TRUE(person.X_OG.isApprox(setting->scene.demonstrator.X_OG, 1e-4));
    const model::CatalogueObject* object = catalogue->find(person.target);
    ASSERT_TRUE(object);
    EXPECT_TRUE(object->shape.size.isApprox(setting->object.shape.size, 1e-3));
    EXPECT_NEAR(object->mass, setting->object.mass, 1e-3);
  }
}

}  // namespace
}  // namespace prehend::cli
