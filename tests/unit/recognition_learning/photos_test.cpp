// Real photos, from the shared data (skipped where it is absent): one fold by background of the
// grocery products is held out, the rest learned. The bounds are far below what is measured over
// all folds (README.md of recognition) and far above chance (1 in 12): with about 70 photos a
// standard error is 2 to 4 points.
#include <gtest/gtest.h>

#include <filesystem>

#include "services/recognition/core/learning/folds.hpp"
#include "services/recognition/tools/evaluation/trial.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::recognition {
namespace {

const std::filesystem::path data = shared_data();

TEST(Photos, GroceryProductsBeforeABackgroundNotSeen) {
  if (!std::filesystem::exists(data / "grocery_store"))
    GTEST_SKIP() << data / "grocery_store"
                 << " is absent";
  auto dataset = load_dataset(data / "grocery_store" / "train");
  ASSERT_TRUE(dataset) << dataset.error().message();
  EXPECT_FALSE(dataset->masks);
  // Every fold but the first is one: what is left to learn from is four fifths.
  std::vector<int> fold = folds_by_background(dataset->classes, 5);
  Dataset held_out;
  std::size_t i = 0;
  for (std::size_t c = 0; c < dataset->classes.size(); ++c) {
    TrainingClass &kept = dataset->classes[c], test{kept.name, {}};
    std::vector<TrainingView> left;
    held_out.files.emplace_back();
    for (std::size_t v = 0; v < kept.views.size(); ++v)
      if (fold[i++] == 0) {
        test.views.push_back(kept.views[v]);
        held_out.files.back().push_back(dataset->files[c][v]);
      } else {
        left.push_back(kept.views[v]);
      }
    kept.views = std::move(left);
    held_out.classes.push_back(std::move(test));
  }
  Dataset strangers;
  if (const auto fridge = load_dataset(data / "fridge_objects" / "single")) strangers = *fridge;
  const auto recogniser = make_recogniser(Method::learned, photos_of_objects());
  ASSERT_TRUE(recogniser->learn(dataset->classes));
  std::vector<int> number(held_out.classes.size());
  for (std::size_t c = 0; c < number.size(); ++c) number[c] = static_cast<int>(c);
  const auto judged =
      judge_all(*recogniser, held_out, number, strangers, [](std::size_t, std::size_t) {});
  const Accepted all = accept(judged, 0), at95 = accept(judged, threshold_for(judged, 0.95));
  EXPECT_GE(all.known, 60u);
  EXPECT_LE(static_cast<double>(all.wrong_accepted), 0.06 * static_cast<double>(all.known));
  EXPECT_LE(static_cast<double>(at95.wrong_accepted), 0.04 * static_cast<double>(all.known));
  EXPECT_GE(static_cast<double>(at95.strangers_rejected),
            0.85 * static_cast<double>(at95.strangers));
}

}  // namespace
}  // namespace prehend::recognition
