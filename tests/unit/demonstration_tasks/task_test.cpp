#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "common/base/random.hpp"
#include "common/tasks/files/task_file.hpp"
#include "common/tasks/table.hpp"
#include "services/demonstration/core/tasks/learn_task.hpp"

namespace prehend::demonstration {
namespace {

Pose at(double x, double y, double z = 0.05) {
  return make_pose({x, y, z});
}

TEST(DrawnTable, SaysWhatDoesNotFitOrIsUnknown) {
  model::CatalogueObject cup;
  cup.name = "cup";
  cup.shape = {model::ShapeKind::box, {0.1, 0.1, 0.1}};
  const model::Catalogue catalogue(std::vector{cup});
  tasks::TableOptions options{.objects = {"cup", "cup"}};
  const auto scene = tasks::drawn_table(catalogue, 1, options);
  ASSERT_TRUE(scene) << scene.error().message();
  options.apart = 2;
  EXPECT_EQ(tasks::drawn_table(catalogue, 1, options).error().message(),
            "scene: there is no room on the table (fewer objects)");
  EXPECT_EQ(tasks::free_place(*scene, 1, options).error().message(),
            "scene: there is no room on the table (fewer objects)");
  options.objects = {"plate"};
  EXPECT_EQ(tasks::drawn_table(catalogue, 1, options).error().message(),
            "plate: is not in the catalogue (see models/objects)");
}

/// A cup is put 12 cm beside a plate that stands elsewhere each time; then a spoon into the cup.
tasks::ShownTask lay_the_table(Random& random) {
  const Pose plate = at(random.uniform(0.3, 0.6), random.uniform(-0.3, 0.3));
  const Pose cup = at(random.uniform(0, 0.2), random.uniform(-0.3, 0.3));
  const Pose spoon = at(random.uniform(0, 0.2), random.uniform(-0.3, 0.3));
  const Pose tray = at(0.8, 0.4);
  const auto noisy = [&](const Pose& X) {
    return make_pose(X.translation() + random.normal3(0.002), Eigen::Matrix3d(X.linear()));
  };
  const Pose cup_put = plate * make_pose({0, 0.12, 0});
  tasks::ShownTask made(2);
  made[0] = {"cup",
             "medium wrap",
             cup * make_pose({0, 0, 0.02}),
             cup,
             noisy(cup_put),
             0.25,
             0.1,
             {{"plate", plate}, {"spoon", spoon}, {"tray", tray}}};
  // Into the cup where it stands, not where it was meant to stand.
  const Pose spoon_put = made[0].X_WO_after * make_pose({0, 0, 0.06});
  made[1] = {"spoon",
             "thumb-2 finger",
             spoon,
             spoon,
             noisy(spoon_put),
             0.3,
             1.2,
             {{"plate", plate}, {"cup", made[0].X_WO_after}, {"tray", tray}}};
  return made;
}

TEST(LearnTask, TakesTheReferenceToWhichPlacesAgreeBest) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    std::vector<tasks::ShownTask> shown;
    for (int i = 0; i < 4; ++i) shown.push_back(lay_the_table(random));
    const auto task = learn_task("lay the table", shown);
    ASSERT_TRUE(task) << task.error().message();
    ASSERT_EQ(task->steps.size(), 2U);
    const tasks::Step& cup = task->steps[0];
    EXPECT_EQ(cup.reference, "plate");
    EXPECT_LT((cup.X_RO.translation() - Eigen::Vector3d(0, 0.12, 0)).norm(), 0.006);
    EXPECT_LT(cup.spread, 0.008);
    EXPECT_NEAR(cup.via_height, 0.2, 0.01);
    EXPECT_TRUE(cup.upright);
    EXPECT_EQ(cup.grasp, "medium wrap");
    EXPECT_LT((cup.X_OG.translation() - Eigen::Vector3d(0, 0, 0.02)).norm(), 1e-9);
    EXPECT_TRUE(cup.after.empty());
    const tasks::Step& spoon = task->steps[1];
    EXPECT_EQ(spoon.reference, "cup");
    EXPECT_FALSE(spoon.upright);
    EXPECT_EQ(spoon.after, std::vector<std::size_t>{0}) << "the cup must be there first";
  }
}

TEST(LearnTask, OfOneDemonstrationTheNearestObjectElseTheTable) {
  tasks::ShownTask shown(1);
  shown[0] = {"cup",      "",  at(0, 0), at(0, 0),
              at(0.4, 0), 0.2, 0,        {{"plate", at(0.4, 0.12)}, {"tray", at(0.4, 0.3)}}};
  EXPECT_EQ(learn_task("t", {shown})->steps[0].reference, "plate");
  shown[0].X_WR["plate"] = at(0.4, 0.16);
  EXPECT_EQ(learn_task("t", {shown})->steps[0].reference, tasks::the_table);
}

TEST(LearnTask, WhatIsPutAtTheSamePlaceOfTheTableIsRelativeToIt) {
  Random random(2);
  std::vector<tasks::ShownTask> shown;
  for (int i = 0; i < 3; ++i)
    shown.push_back({{"cup",
                      "",
                      at(0, 0),
                      at(random.uniform(), 0),
                      at(0.5, 0.2),
                      0.2,
                      0,
                      {{"plate", at(random.uniform(), random.uniform())}}}});
  EXPECT_EQ(learn_task("t", shown)->steps[0].reference, tasks::the_table);
}

TEST(LearnTask, SaysWhenDemonstrationsDiffer) {
  Random random(3);
  const auto one = lay_the_table(random);
  auto other = one;
  other[1].object = "fork";
  EXPECT_FALSE(learn_task("t", {one, other}));
  other.pop_back();
  EXPECT_FALSE(learn_task("t", {one, other}));
  EXPECT_FALSE(learn_task("t", {}));
  EXPECT_FALSE(learn_task("t", {tasks::ShownTask{}}));
}

TEST(TaskModel, OrderKeepsWhatMustComeFirst) {
  tasks::TaskModel task{"t", 1, std::vector<tasks::Step>(3)};
  for (std::size_t i = 0; i < 3; ++i) task.steps[i].object = "o" + std::to_string(i);
  task.steps[0].after = {2};
  EXPECT_EQ(*tasks::order_of(task), (std::vector<std::size_t>{1, 2, 0}));
  ASSERT_TRUE(check(task));
  task.steps[2].after = {0};
  ASSERT_FALSE(check(task));
  EXPECT_NE(check(task).error().what.find("circle"), std::string::npos);
  task.steps[2].after = {7};
  EXPECT_EQ(check(task).error().where, "t, step 3");
}

TEST(TaskModel, SaysWhatIsWrongWithAStep) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  tasks::Step sound;
  sound.object = "cup";
  std::vector<tasks::Step> wrong(9, sound);
  wrong[0].reference.clear();
  wrong[1].reference = "cup";
  wrong[2].grasp.assign(65, 'g');
  wrong[3].X_OG.translation().x() = nan;
  wrong[4].X_RO.translation().x() = nan;
  wrong[5].spread = -1;
  wrong[6].spread = nan;
  wrong[7].via_height = 2.1;
  wrong[8].object.clear();
  const std::vector<std::string> told{"needs a reference, an object or the table",
                                      "puts an object relative to itself",
                                      "the name of its grasp is too long",
                                      "a pose is not finite",
                                      "a pose is not finite",
                                      "its spread is not a length of 0 or more",
                                      "its spread is not a length of 0 or more",
                                      "its via height is not between 0 and 2 m",
                                      "needs the name of an object, 1 to 64 bytes"};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    const auto made = check(tasks::TaskModel{"t", 1, {sound, wrong[i]}});
    ASSERT_FALSE(made) << told[i];
    EXPECT_EQ(made.error().message(), "t, step 2: " + told[i]);
  }
}

TEST(TaskFile, ComesBackBitForBitAndDamageIsTold) {
  Random random(4);
  const auto task = learn_task("lay \"the\" table", {lay_the_table(random), lay_the_table(random)});
  ASSERT_TRUE(task);
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("t" + std::to_string(getpid()) + ".task");
  ASSERT_TRUE(tasks::save_task(file, *task));
  const auto back = tasks::load_task(file);
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(to_toml(*back), to_toml(*task));
  for (std::size_t i = 0; i < task->steps.size(); ++i) {
    EXPECT_EQ(back->steps[i].X_RO.matrix(), task->steps[i].X_RO.matrix());
    EXPECT_EQ(back->steps[i].X_OG.matrix(), task->steps[i].X_OG.matrix());
    EXPECT_EQ(back->steps[i].after, task->steps[i].after);
  }
  EXPECT_NE(to_toml(*task).find("name = \"lay \\\"the\\\" table\""), std::string::npos);
  std::ofstream(file, std::ios::app) << "x";
  const auto damaged = tasks::load_task(file);
  std::filesystem::remove(file);
  ASSERT_FALSE(damaged);
  EXPECT_FALSE(tasks::load_task(file));
  tasks::TaskModel nothing;
  EXPECT_FALSE(tasks::save_task(file, nothing)) << "what is no task is not written";
}

TEST(TaskFile, KeepsWhatItWasLearntFromAndHowItWent) {
  Random random(4);
  const std::vector<tasks::ShownTask> shown{lay_the_table(random), lay_the_table(random)};
  const tasks::TaskRecord record{
      *learn_task("lay", shown),
      shown,
      {{from_ns(5), "barrett", false, "step 1, Cup: lift: was not lifted"},
       {from_ns(6), "barrett", true, ""}}};
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("r" + std::to_string(getpid()) + ".task");
  ASSERT_TRUE(tasks::save_record(file, record));
  const auto back = tasks::load_record(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(back) << back.error().message();
  // Learnt again from what was kept, it is the same task.
  EXPECT_EQ(to_toml(*learn_task("lay", back->shown)), to_toml(record.task));
  ASSERT_EQ(back->runs.size(), 2u);
  EXPECT_EQ(back->runs[0].reason, record.runs[0].reason);
  EXPECT_TRUE(back->runs[1].done);
  EXPECT_EQ(back->runs[1].stamp, from_ns(6));
}

// A file may come from elsewhere: what it was learnt from is not checked when it is written.
TEST(TaskFile, ShownStepsHoldFiniteNumbers) {
  Random random(4);
  std::vector<tasks::ShownTask> shown{lay_the_table(random), lay_the_table(random)};
  const auto task = learn_task("lay", shown);
  shown[0][0].highest = std::numeric_limits<double>::infinity();
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("n" + std::to_string(getpid()) + ".task");
  ASSERT_TRUE(tasks::save_record(file, {*task, shown, {}}));
  const auto back = tasks::load_record(file);
  std::filesystem::remove(file);
  ASSERT_FALSE(back);
  EXPECT_NE(back.error().what.find("a number is not finite"), std::string::npos)
      << back.error().message();
}

TEST(TaskFile, NamesAreNamesOfFiles) {
  EXPECT_EQ(tasks::task_path("lay the table", "tasks")->string(), "tasks/lay the table.task");
  EXPECT_EQ(tasks::task_path("some/where.task", "tasks")->string(), "some/where.task");
  for (const char* name : {"", "../tea", "a/b", ".tea", "-tea", "tea\n"})
    EXPECT_FALSE(tasks::task_path(name, "tasks")) << name;
  EXPECT_FALSE(tasks::task_path("tea", "")) << "nowhere to look";
}

TEST(TaskToml, ComesBackAndSaysWhatIsWrong) {
  Random random(4);
  const auto task = learn_task("lay", {lay_the_table(random), lay_the_table(random)});
  const std::string text = to_toml(*task);
  const auto back = tasks::from_toml(text, "lay.toml");
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(to_toml(*back), text);
  const auto refused = [&](const std::string& what, const std::string& by) {
    std::string other = text;
    other.replace(other.find(what), what.size(), by);
    const auto made = tasks::from_toml(other, "lay.toml");
    return made ? std::string("taken") : made.error().message();
  };
  EXPECT_NE(refused("upright", "uprigth").find("uprigth"), std::string::npos);
  EXPECT_NE(
      refused("position_m = [", "position_m = [nan, ").find("position_m is not a finite number"),
      std::string::npos);
  EXPECT_NE(refused("after = []", "after = [9]").find("after step 9"), std::string::npos);
  EXPECT_NE(refused("after = []", "after = [0]").find("comes after what is no step"),
            std::string::npos);
  EXPECT_NE(refused("name = ", "name ").find("lay.toml"), std::string::npos);
  // A value of another type passed as an absent one, and the step lost what it said.
  for (const char* by : {"after = 1", "after = \"1\""})
    EXPECT_NE(refused("after = []", by).find("after is no list"), std::string::npos) << by;
  const auto another = [&](const std::string& key, const std::string& value) {
    const std::size_t from = text.find("\n" + key + " = ") + 1;
    std::string other = text;
    other.replace(from, text.find('\n', from) - from, key + " = " + value);
    const auto made = tasks::from_toml(other, "lay.toml");
    return made ? std::string("taken") : made.error().message();
  };
  for (const auto& [key, value] :
       {std::pair("upright", "\"true\""), std::pair("upright", "1"), std::pair("object", "5"),
        std::pair("grasp", "[]"), std::pair("relative_to", "1"), std::pair("demonstrations", "-1"),
        std::pair("demonstrations", "\"2\"")}) {
    const std::string told = another(key, value);
    EXPECT_NE(told.find(key), std::string::npos) << key << " = " << value << ": " << told;
  }
  for (const char* key : {"place", "grasp_frame"})
    EXPECT_NE(another(key, "3").find(std::string(key) + ": is missing or no table"),
              std::string::npos)
        << another(key, "3");
  EXPECT_EQ(another("upright", "true"), "taken");
  EXPECT_EQ(another("demonstrations", "1000000"), "taken");
  // What nobody can have shown.
  for (const auto& [key, value] :
       {std::pair("name", "\"../tea\""), std::pair("name", "\"a/b\""),
        std::pair("demonstrations", "9223372036854775807"), std::pair("via_height_m", "1000.0")})
    EXPECT_NE(another(key, value), "taken") << key << " = " << value;
  const std::size_t place = text.find("position_m = [");
  const std::string far = "position_m = [1000.0, 0, 0]";
  EXPECT_NE(refused(text.substr(place, text.find(']', place) + 1 - place), far).find("too far"),
            std::string::npos);
}

}  // namespace
}  // namespace prehend::demonstration
