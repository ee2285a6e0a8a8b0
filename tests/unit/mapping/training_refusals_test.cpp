// What a mapping cannot be trained with is refused by name: grasps that are none, and sets of other
// hands or of other features.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include "common/proto/robot_grasps.pb.h"
#include "services/mapping/tools/training/training_run.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using testing::HasSubstr;

void one_by_one(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

Scheme scheme_of_barrett() {
  return Scheme::load(test::in_sources("services/mapping/schemes/barrett.toml"), barrett()).value();
}

std::vector<RobotGrasp> first_grasp() {
  auto all = load_robot_grasps(test::in_share("trained/barrett.grasps"), barrett()).value();
  return {std::move(all.front())};
}

TEST(RobotGraspsInAFile, AreRefusedByWhatTheyLack) {
  using Spoil = void (*)(messages::RobotGrasp&);
  const std::vector<std::pair<Spoil, const char*>> spoilt{
      {[](auto&) {}, "taken"},
      {[](auto& grasp) { grasp.set_type("karate"); }, "a grasp without type or shape"},
      {[](auto& grasp) { grasp.set_size(0, -1); }, "a grasp of what has no size"},
      {[](auto& grasp) { grasp.add_dof(0); }, "a grasp with another number of DoF"},
      {[](auto& grasp) { grasp.set_dof(0, std::nan("")); }, "a grasp is not finite"},
      {[](auto& grasp) { grasp.clear_place(); }, "a grasp without a place"},
      {[](auto& grasp) { grasp.set_place(1, HUGE_VAL); }, "a grasp is not finite"}};
  const std::string good = encode_robot_grasps(barrett(), first_grasp());
  for (const auto& [spoil, words] : spoilt) {
    messages::RobotGrasps message;
    ASSERT_TRUE(message.ParseFromString(good));
    spoil(*message.mutable_grasps(0));
    const auto made = decode_robot_grasps(message.SerializeAsString(), barrett());
    EXPECT_THAT(made ? "taken" : made.error().message(), HasSubstr(words));
  }
  EXPECT_EQ(decode_robot_grasps("\xff", barrett()).error().what, "holds no grasps");
}

TEST(TrainingSets, OfOtherFeaturesAreRefused) {
  learning::TrainingSet set = demonstrate(barrett(), scheme_of_barrett(), {}, {.users = 1});
  for (learning::TrainingPair& pair : set.pairs) pair.features.conservativeResize(3);
  const auto made = train_mapping(barrett(), scheme_of_barrett(), {set, set, set}, {}, one_by_one,
                                  [](auto, auto) {});
  EXPECT_EQ(made.error().message(), "barrett: a training set with other features");
}

TEST(TrainingSets, ThatWereTaughtForAnotherHandAreRefused) {
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("dlr" + std::to_string(getpid()) + ".set");
  learning::TrainingSet set = demonstrate(barrett(), scheme_of_barrett(), {}, {.users = 1});
  set.hand = "dlr";
  ASSERT_TRUE(learning::save(file.string(), set));
  TrainingRun run;
  run.grasps = test::in_share("trained/barrett.grasps");
  run.people.users = 1;
  run.taught = {file};
  const auto made =
      run_training(run, barrett(), scheme_of_barrett(), one_by_one, [](auto, auto) {});
  std::filesystem::remove(file);
  EXPECT_EQ(made.error().message(), file.string() + ": is for the hand «dlr», not for «barrett»");
}

}  // namespace
}  // namespace prehend::mapping
