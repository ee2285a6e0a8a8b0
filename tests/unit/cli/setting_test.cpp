// Scenes of the demonstration: drawn among what the hand can hold, the same for the same seed.
#include "services/cli/tools/demo/setting.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <set>

#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::cli {
namespace {

const std::filesystem::path models = std::filesystem::path(test::in_sources("common")) / "models";

SettingOptions options(std::uint64_t seed) {
  return {seed, "", models / "hands" / "barrett", models / "objects" / "catalogue.toml"};
}

TEST(Setting, SeedDecidesEverything) {
  const auto first = make_setting(options(5)), again = make_setting(options(5)),
             other = make_setting(options(6));
  ASSERT_TRUE(first) << first.error().message();
  ASSERT_TRUE(again && other);
  EXPECT_EQ(model::to_toml(*first), model::to_toml(*again));
  EXPECT_NE(model::to_toml(*first), model::to_toml(*other));
}

TEST(Setting, TargetsFitTheHandAndVary) {
  const auto hand = model::HandModel::load(models / "hands" / "barrett");
  const auto catalogue = model::Catalogue::load(models / "objects" / "catalogue.toml");
  ASSERT_TRUE(hand && catalogue);
  std::set<std::string> targets;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto scene = make_setting(options(seed));
    ASSERT_TRUE(scene) << scene.error().message();
    const std::string& target = scene->demonstrator.target;
    EXPECT_TRUE(
        model::nearest_grasp(catalogue->find(target)->shape, Pose::Identity(), hand->reach()))
        << target;
    targets.insert(target);
  }
  EXPECT_GE(targets.size(), 4u);
}

// DLR's straight fingers met the table before they met the object: the person reached as deep as a
// human hand can.
TEST(Setting, ThePersonGivesTheRobotHandTheRoomItNeeds) {
  for (const std::string& name : test::mappable_hands()) {
    SettingOptions wishes = options(3);
    wishes.hand = models / "hands" / name;
    const auto hand = model::HandModel::load(wishes.hand);
    const auto scene = make_setting(wishes);
    ASSERT_TRUE(hand && scene) << name;
    EXPECT_EQ(scene->demonstrator.reach.clearance, hand->reach().clearance) << name;
    EXPECT_EQ(scene->demonstrator.reach.half_width, hand->reach().half_width) << name;
    EXPECT_EQ(scene->demonstrator.reach.opening, hand->reach().opening) << name;
    EXPECT_EQ(scene->demonstrator.reach.engage, hand->reach().engage) << name;
  }
}

TEST(Setting, ABareHandIsPutAtTheObject) {
  const auto scene = make_setting(options(3));
  ASSERT_TRUE(scene) << scene.error().message();
  const Eigen::Vector3d p_WO = scene->objects.front().X_WO.translation();
  // The back of the hand is a palm's thickness and half a finger away from the object's axis; the
  // largest object reaches 0.1 m to its side.
  EXPECT_LT((scene->X_WH.translation() - p_WO).head<2>().norm(), 0.25);
  EXPECT_GT(scene->X_WH.translation().z(), 0.02) << "above the table";
}

TEST(Setting, UnknownObjectAndHandAreNamed) {
  SettingOptions wrong = options(1);
  wrong.object = "Spoon";
  EXPECT_NE(make_setting(wrong).error().message().find("Spoon"), std::string::npos);
  wrong = options(1);
  wrong.hand = models / "hands" / "claw";
  EXPECT_NE(make_setting(wrong).error().message().find("claw"), std::string::npos);
}

TEST(Setting, WhatNoHandHoldsAndWhereNothingIsWrittenAreNamed) {
  const auto scene = make_setting(options(1));
  ASSERT_TRUE(scene);
  EXPECT_EQ(write_setting(*scene, "/nowhere/scene.toml").error().message(),
            "/nowhere/scene.toml: cannot be written (is there room, and is the folder writable?)");
  SettingOptions wrong = options(1);
  wrong.catalogue =
      std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + ".toml");
  std::ofstream(wrong.catalogue) << "[[object]]\nname = \"Ball\"\nshape = \"sphere\"\n"
                                    "size = [0.4, 0.4, 0.4]\nmass = 1\nmaterial = \"plastic\"\n";
  const auto nothing = make_setting(wrong);
  std::filesystem::remove(wrong.catalogue);
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().message().find("barrett: the hand can hold nothing of the catalogue"),
            std::string::npos)
      << nothing.error().message();
}

}  // namespace
}  // namespace prehend::cli
