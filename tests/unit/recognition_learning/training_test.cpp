// What is learned must name views that were not seen, say «unknown» of what is none of it, and stay
// the same when a class is added later.
#include <gtest/gtest.h>

#include "services/recognition/core/learning/answer.hpp"
#include "services/recognition/files/model_file.hpp"
#include "tests/unit/recognition_learning/painted.hpp"

namespace prehend::recognition {
namespace {

DescriptorOptions small() {
  DescriptorOptions made;
  made.colours = 16;
  made.coarse_colours = 8;
  return made;
}

double share_named(const ObjectModels& models, const std::vector<TrainingClass>& classes) {
  int right = 0, all = 0;
  for (const TrainingClass& c : classes)
    for (const TrainingView& view : c.views) {
      const Classification seen = named(models, view);
      ++all;
      right += seen.best >= 0 && models.classes[static_cast<std::size_t>(seen.best)].name == c.name;
    }
  return static_cast<double>(right) / all;
}

TEST(Training, NamesUnseenViewsWithEveryWeightingAndSpace) {
  for (const Weighting weighting :
       {Weighting::idf_hellinger, Weighting::hellinger, Weighting::intersection})
    for (const Colours space : {Colours::chromaticity, Colours::lab}) {
      DescriptorOptions options = small();
      options.weighting = weighting;
      options.space.colours = space;
      const auto models = train(painted_classes(5, 1), options);
      ASSERT_TRUE(models);
      EXPECT_TRUE(models->check());
      EXPECT_EQ(share_named(*models, painted_classes(5, 2)), 1);
    }
}

TEST(Training, OptionsComeBackFromTheFile) {
  DescriptorOptions options = small();
  options.space = {0.1, 7, Constancy::shades_of_grey, Colours::lab};
  options.weighting = Weighting::intersection;
  options.same_pairs = 0.25;
  options.distances = {0, 2, 5};
  options.varied = 1;
  const auto models = train(painted_classes(2, 1), options);
  ASSERT_TRUE(models);
  const auto back = from_bytes(to_bytes(*models));
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(back->palette.space().constancy, Constancy::shades_of_grey);
  EXPECT_EQ(back->palette.space().colours, Colours::lab);
  EXPECT_EQ(back->weighting, Weighting::intersection);
  EXPECT_EQ(back->same_pairs, 0.25);
  const TrainingView view = painted_classes(2, 9)[1].views[0];
  EXPECT_EQ(named(*back, view).probability, named(*models, view).probability);
}

// The second way must agree with the first: a class learned later is known as if it had been there
// from the start, as far as the palette has its colours.
TEST(Training, AClassAddedLaterIsKnownAndTheOthersStay) {
  std::vector<TrainingClass> classes = painted_classes(5, 1);
  const auto together = train(classes, small());
  const TrainingClass last = classes.back();
  classes.pop_back();
  // The palette has seen the third thing's colours before one of the backgrounds only.
  const auto before = train(classes, small());
  ASSERT_TRUE(together && before);
  const auto after = with_class(*before, last, small());
  ASSERT_TRUE(after) << after.error().message();
  EXPECT_TRUE(after->check());
  EXPECT_EQ(after->classes.size(), 3u);
  EXPECT_EQ(after->views.cols(), together->views.cols());
  EXPECT_EQ(share_named(*after, painted_classes(5, 2)), 1);
  EXPECT_FALSE(with_class(*after, last, small()));  // known already
  EXPECT_FALSE(with_class(*after, TrainingClass{"none", {}}, small()));
}

TEST(Training, StrangersAreDoubted) {
  const auto models = train(painted_classes(5, 1), small());
  ASSERT_TRUE(models);
  Random random(7);
  int accepted = 0;
  for (int i = 0; i < 20; ++i) {
    const TrainingView stranger =
        painted({230, 140, 20}, {120, 30, 140}, {90, 160, 90}, 2 + i % 5, random);
    accepted += named(*models, stranger).probability >= 0.5;
  }
  EXPECT_LE(accepted, 2);
  double sum = 0;
  const auto unseen = painted_classes(5, 2);
  for (const TrainingClass& c : unseen)
    for (const TrainingView& view : c.views) sum += named(*models, view).probability;
  EXPECT_GT(sum / 45, 0.8);
}

// A thing of the first class' colours, in large fields instead of small ones, is told from it once
// such things were shown, also by whoever learns a class later or reads the model from a file; the
// classes are named as before.
TEST(Training, OthersThatWereShownAreDoubted) {
  Random random(7);
  std::vector<TrainingClass> others;
  const auto alike = [&](int k) {
    return painted({210, 40, 40}, {240, 240, 240}, {90, 160, 90}, 12 + 2 * k, random);
  };
  for (int k = 0; k < 5; ++k) {
    others.push_back({"other " + std::to_string(k), {}});
    for (int i = 0; i < 3; ++i) others.back().views.push_back(alike(k));
  }
  std::vector<TrainingClass> classes = painted_classes(5, 1);
  const auto unaware = train(classes, small());
  const auto aware = train(classes, small(), 60, others);
  const TrainingClass last = classes.back();
  classes.pop_back();
  const auto fewer = train(classes, small(), 60, others);
  ASSERT_TRUE(unaware && aware && fewer);
  const auto added = with_class(*fewer, last, small());
  ASSERT_TRUE(added);
  const auto read = from_bytes(to_bytes(*aware));
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->view_class, aware->view_class);
  // Each of their views and a part of it.
  EXPECT_EQ(std::count(added->view_class.begin(), added->view_class.end(), -1), 30);
  const auto accepted = [&](const ObjectModels& models) {
    int made = 0;
    for (int i = 0; i < 20; ++i) made += named(models, alike(i % 5)).probability >= 0.5;
    return made;
  };
  EXPECT_GE(accepted(*unaware), 10);
  EXPECT_LE(accepted(*aware), 2);
  EXPECT_LE(accepted(*added), 2);
  EXPECT_LE(accepted(*read), 2);
  EXPECT_EQ(share_named(*aware, painted_classes(5, 2)), 1);
}

// Between turquoise and green: a palette of nothing but the classes' colours has one colour for
// both, and a turquoise thing before a green one was taken for a part of it.
TEST(Training, ColoursOfOtherThingsAreToldFromTheClasses) {
  const Eigen::Vector3i turquoise(40, 190, 170);
  Random random(3);
  std::vector<TrainingClass> others{{"other", {}}};
  for (int i = 0; i < 6; ++i)
    others[0].views.push_back(painted(turquoise, turquoise, {90, 160, 90}, 3, random));
  const auto unaware = train(painted_classes(5, 1), small());
  const auto aware = train(painted_classes(5, 1), small(), 60, others);
  ASSERT_TRUE(unaware && aware);
  const auto share = [&](const ObjectModels& models) {  // of turquoise on the green thing
    const int colour = models.palette.nearest(colour_feature(models.palette.space(), 40, 190, 170));
    return models.classes[1].colours[colour];
  };
  EXPECT_GT(share(*unaware), 0.1);
  EXPECT_LT(share(*aware), 0.02);
}

// What is learned as a part shows 55 to 80 % of the whole, and nothing beside it.
TEST(Training, PartsOfAMaskAreAsLargeAsSaid) {
  const Plane mask = centred_mask(48, 64);
  const auto count = [](const Plane& plane) {
    return static_cast<double>(std::count(plane.values.begin(), plane.values.end(), 1));
  };
  Random random(4);
  double least = 1, most = 0;
  for (int i = 0; i < 100; ++i) {
    const Plane part = part_of(mask, random);
    for (std::size_t p = 0; p < mask.values.size(); ++p) ASSERT_LE(part.values[p], mask.values[p]);
    least = std::min(least, count(part) / count(mask));
    most = std::max(most, count(part) / count(mask));
  }
  EXPECT_NEAR(least, 0.55, 0.04);
  EXPECT_NEAR(most, 0.8, 0.04);
  EXPECT_EQ(count(part_of(Plane(8, 8), random)), 0);
}

TEST(PhotoAnswer, ObjectTwoObjectsUnknownAndNothing) {
  const auto models = train(painted_classes(5, 1), small());
  ASSERT_TRUE(models);
  const auto unseen = painted_classes(5, 2);
  const Picture &first = unseen[0].views[0].picture, &second = unseen[1].views[0].picture;
  const PhotoAnswer one = answer(*models, first);
  EXPECT_EQ(one.verdict, PhotoVerdict::object);
  EXPECT_EQ(one.first, 0);
  Picture both(2 * first.width, first.height);
  for (int y = 0; y < both.height; ++y)
    for (int x = 0; x < both.width; ++x)
      std::copy_n(x < first.width ? first.at(x, y) : second.at(x - first.width, y), 3,
                  both.at(x, y));
  const PhotoAnswer two = answer(*models, both);
  EXPECT_EQ(two.verdict, PhotoVerdict::two_objects);
  EXPECT_EQ(std::pair(two.first, two.second), std::pair(0, 1));
  Random random(7);
  EXPECT_EQ(
      answer(*models, painted({230, 140, 20}, {120, 30, 140}, {90, 160, 90}, 3, random).picture)
          .verdict,
      PhotoVerdict::unknown);
  const Eigen::Vector3i table(120, 110, 90);
  EXPECT_EQ(answer(*models, painted(table, table, table, 3, random).picture).verdict,
            PhotoVerdict::nothing);
  EXPECT_EQ(answer(*models, Picture(4, 4)).verdict, PhotoVerdict::unknown);
}

TEST(Varied, KeepsTheSizeAndChangesTheLight) {
  const Picture picture = painted_classes(1, 1)[0].views[0].picture;
  Random random(1), same(1);
  const Picture a = varied(picture, random), b = varied(picture, same), c = varied(picture, random);
  EXPECT_EQ(a.width, picture.width);
  EXPECT_EQ(a.height, picture.height);
  EXPECT_EQ(a.rgb, b.rgb);
  EXPECT_NE(a.rgb, c.rgb);
}

}  // namespace
}  // namespace prehend::recognition
