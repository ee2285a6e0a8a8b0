// The baselines name what they can tell apart; the false-alarm model is a probability that falls as
// the similarity grows, and says of features drawn as it assumes what really happens.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "services/recognition/core/learning/folds.hpp"
#include "services/recognition/tools/evaluation/false_alarm.hpp"
#include "services/recognition/tools/evaluation/trial.hpp"
#include "tests/unit/recognition_learning/painted.hpp"

namespace prehend::recognition {
namespace {

Dataset painted_dataset(int backgrounds, std::uint64_t seed) {
  Dataset made;
  made.classes = painted_classes(backgrounds, seed);
  for (const TrainingClass& c : made.classes) {
    made.files.emplace_back();
    for (std::size_t i = 0; i < c.views.size(); ++i)
      made.files.back().push_back(c.name + "/" + std::to_string(i));
  }
  return made;
}

void ignore(std::size_t, std::size_t) {}

TEST(Recogniser, EveryMethodTellsPaintedThingsApartInFolds) {
  const Dataset dataset = painted_dataset(5, 1);
  const std::vector<int> fold = folds_by_background(dataset.classes, 5);
  DescriptorOptions options;
  options.colours = 16;
  options.coarse_colours = 8;
  for (const Method method :
       {Method::learned, Method::nearest_view, Method::false_alarm, Method::histogram}) {
    const auto judged = cross_validate(method, options, dataset, fold, {}, false, ignore);
    ASSERT_TRUE(judged) << judged.error().message();
    EXPECT_EQ(judged->size(), 45u);
    const Accepted all = accept(*judged, 0);
    EXPECT_EQ(all.known, 45u);
    EXPECT_EQ(all.wrong_accepted, 0u) << to_string(method);
  }
}

// Other light must change what is judged, and what was learned in varied light must bear it.
TEST(Recogniser, OtherLightIsBorneByVariedCopies) {
  const Dataset dataset = painted_dataset(5, 1);
  const std::vector<int> fold = folds_by_background(dataset.classes, 5);
  DescriptorOptions options;
  options.colours = 16;
  options.coarse_colours = 8;
  options.varied = 3;
  const auto plain = cross_validate(Method::learned, options, dataset, fold, {}, false, ignore);
  const auto other = cross_validate(Method::learned, options, dataset, fold, {}, true, ignore);
  ASSERT_TRUE(plain && other);
  EXPECT_NE(plain->front().probability, other->front().probability);
  EXPECT_LE(accept(*other, 0).wrong_accepted, 2u);
}

TEST(Recogniser, LeavingAClassOutMakesItsPicturesStrangers) {
  DescriptorOptions options;
  options.colours = 16;
  options.coarse_colours = 8;
  const auto judged = leave_classes_out(Method::learned, options, painted_dataset(5, 1), ignore);
  ASSERT_TRUE(judged);
  EXPECT_EQ(accept(*judged, 0.5).strangers, 45u);
  EXPECT_GT(accept(*judged, 0.5).strangers_rejected, 40u);
}

// Blobs at other places, sizes and brightness: features that colour does not have.
TEST(Recogniser, SiftTellsPatternsOfOneColourApart) {
  const auto blobs = [](std::uint64_t pattern, std::uint64_t noise) {
    Random places(pattern), random(noise);
    TrainingView view{Picture(160, 160), Plane(160, 160, 1)};
    for (auto& v : view.picture.rgb) v = static_cast<std::uint8_t>(100 + random.index(6));
    for (int k = 0; k < 40; ++k) {
      const double x = places.uniform(10, 150), y = places.uniform(10, 150);
      const double r = places.uniform(3, 9), bright = places.uniform(-90, 140);
      for (int v = 0; v < 160; ++v)
        for (int u = 0; u < 160; ++u)
          if (std::hypot(u - x, v - y) < r)
            std::fill_n(view.picture.at(u, v), 3, static_cast<std::uint8_t>(100 + bright));
    }
    return view;
  };
  std::vector<TrainingClass> classes{{"a", {blobs(1, 1), blobs(1, 2)}}, {"b", {blobs(2, 3)}}};
  const auto recogniser = make_recogniser(Method::sift, {});
  ASSERT_TRUE(recogniser->learn(classes));
  EXPECT_EQ(recogniser->name(blobs(1, 9)).best, 0);
  EXPECT_EQ(recogniser->name(blobs(2, 9)).best, 1);
  const TrainingView flat{Picture(64, 64), Plane(64, 64, 1)};
  EXPECT_EQ(recogniser->name(flat).best, -1);  // has no feature
  EXPECT_FALSE(make_recogniser(Method::sift, {})->learn({{"flat", {flat}}}));
}

TEST(FalseAlarm, FallsWithSimilarity) {
  const auto models = train(painted_classes(3, 1), {.colours = 16, .coarse_colours = 8});
  ASSERT_TRUE(models);
  const FalseAlarm model(*models);
  for (int c = 0; c < 3; ++c) {
    double before = 1 + 1e-12;
    for (double s = 0; s <= 1; s += 0.05) {
      const double p = model.probability(c, s);
      EXPECT_GE(p, 0);
      EXPECT_LE(p, before);
      before = p;
    }
    EXPECT_LT(model.probability(c, 1), 0.5);
  }
}

TEST(Groups, FileIsReadAndEveryFaultNamed) {
  const Dataset dataset = painted_dataset(2, 1);  // three classes of six
  const auto file =
      std::filesystem::temp_directory_path() / ("objects-groups" + std::to_string(getpid()));
  const auto read = [&](const std::string& text) {
    std::ofstream(file) << text;
    return folds_from(file, dataset);
  };
  const std::string rest = "thing 1,0,5\nthing 2,0,2\nthing 2,3,5\n";
  const auto good = read("# groups\nthing 0,0,1\nthing 0,2,5\n" + rest);
  ASSERT_TRUE(good) << good.error().message();
  EXPECT_EQ(*good, (std::vector<int>{0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1}));
  for (const char* bad : {"thing 0,0,6\n", "thing 9,0,1\n", "thing 0,3,1\n", "thing 0,x,1\n",
                          "thing 0\n", "thing 0,0,4\n"}) {
    const auto refused = read(bad + rest);
    EXPECT_FALSE(refused) << bad;
  }
  std::filesystem::remove(file);
  EXPECT_FALSE(folds_from(file, dataset));
}

}  // namespace
}  // namespace prehend::recognition
