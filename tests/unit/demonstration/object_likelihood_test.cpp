#include "services/demonstration/core/recognition/object_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.hpp"
#include "services/demonstration/tools/evaluation/trial.hpp"
#include "tests/support/takes/made_takes.hpp"

namespace prehend::demonstration {
namespace {

using model::ShapeKind;

model::Shape ball(double radius) {
  return {ShapeKind::sphere, Eigen::Vector3d::Constant(radius)};
}

std::vector<const Take*> each_of(const std::vector<Take>& takes) {
  std::vector<const Take*> made;
  for (const Take& take : takes) made.push_back(&take);
  return made;
}

/// Small and large balls, by turns.
std::vector<Take> balls(int count) {
  Random random(1);
  std::vector<Take> made;
  for (int n = 0; n < count; ++n) {
    made.push_back({.label = n % 2 == 0 ? "small" : "large", .samples = {}});
    made.back().object = ball(std::exp(random.normal(0.1)) * (n % 2 == 0 ? 0.01 : 0.05));
  }
  return made;
}

TEST(ObjectLikelihood, IsHowOftenAKindGoesWithSuchAShapeAndSize) {
  const auto takes = balls(40);
  const auto made = ObjectLikelihood::learn(each_of(takes), {"large", "never", "small"});
  ASSERT_TRUE(made) << made.error().message();
  const Eigen::VectorXd p = made->of(ball(0.011));
  EXPECT_GT(p[2], 20 * p[0]);
  EXPECT_GT(p.minCoeff(), 0) << "nothing is impossible";
  const Eigen::VectorXd box = made->of({ShapeKind::box, {0.02, 0.03, 0.05}});
  EXPECT_NEAR(box[0], box[2], 1e-12) << "nobody grasped one";
  EXPECT_GT(box[1], box[0]) << "of what nobody showed everything is possible";
}

TEST(ObjectLikelihood, IsADensity) {
  // Over all shapes and sizes that one kind may go with, the probabilities sum to 1.
  const auto takes = balls(40);
  const auto made = ObjectLikelihood::learn(each_of(takes), {"large", "small"});
  double sum = 0;
  const double step = 0.01;
  for (double x = -15; x < 9; x += step) {
    const double size = std::exp(x);
    sum += step * made->of(ball(size))[0];
  }
  EXPECT_NEAR(sum, (20 + 0.5) / (20 + 1.5), 1e-3) << "the share of spheres";
}

// Kinds of grasps end where a hand is too small or too large: a width a tenth beyond all that were
// shown speaks against the kind, however many were near that end.
TEST(ObjectLikelihood, KindsEndAtTheirWidths) {
  Random random(2);
  std::vector<Take> takes;
  for (int n = 0; n < 400; ++n) {
    takes.push_back({.label = n % 2 == 0 ? "narrow" : "wide", .samples = {}});
    takes.back().object =
        ball(n % 2 == 0 ? random.uniform(0.01, 0.02) : random.uniform(0.02, 0.04));
  }
  const auto made = ObjectLikelihood::learn(each_of(takes), {"narrow", "wide"});
  EXPECT_GT(made->of(ball(0.0235))[1], 5 * made->of(ball(0.0235))[0]);
  EXPECT_GT(made->of(ball(0.017))[0], 5 * made->of(ball(0.017))[1]);
}

// Of a few objects each speaks for all between it and its neighbours: a size that nobody showed is
// not ruled out by chance.
TEST(ObjectLikelihood, FewObjectsSpeakFarther) {
  std::vector<Take> takes;
  for (const double radius : {0.01, 0.0125, 0.016, 0.02, 0.025, 0.031}) {
    takes.push_back({.label = "own", .samples = {}});
    takes.back().object = ball(radius);
  }
  const auto made = ObjectLikelihood::learn(each_of(takes), {"own"});
  const double shown = made->of(ball(0.016))[0], between = made->of(ball(0.018))[0];
  EXPECT_NEAR(between / shown, 1, 0.2);
}

TEST(ObjectLikelihood, RefusesNumbersThatDoNotFit) {
  const auto good = ObjectLikelihood::learn(each_of(balls(40)), {"large", "small"});
  ASSERT_TRUE(ObjectLikelihood::create(good->sizes(), good->otherwise()));
  for (int broken = 0; broken < 5; ++broken) {
    auto sizes = good->sizes();
    auto otherwise = good->otherwise();
    if (broken == 0) otherwise[1] = 0;
    if (broken == 1) sizes[0].kind = 2;
    if (broken == 2) sizes[0].share = std::nan("");
    if (broken == 3) sizes[0].shape = ShapeKind::box;
    if (broken == 4) sizes[1].shown(0, 3) = std::nan("");
    EXPECT_FALSE(ObjectLikelihood::create(sizes, otherwise)) << broken;
  }
}

TEST(ObjectLikelihood, NeedsObjectsAndBearsFewTakes) {
  auto takes = balls(4);
  const auto few = ObjectLikelihood::learn(each_of(takes), {"large", "small"});
  ASSERT_TRUE(few);
  const Eigen::VectorXd p = few->of(ball(0.03));
  EXPECT_GT(p.minCoeff(), 0);
  EXPECT_NEAR(p[0], p[1], 1e-12) << "too few to say how large such objects are";
  for (Take& take : takes) take.object.reset();
  const auto none = ObjectLikelihood::learn(each_of(takes), {"large", "small"});
  ASSERT_FALSE(none);
  EXPECT_FALSE(none.error().hint.empty());
}

// Kinds that look alike but go with objects of other sizes: the object tells them.
TEST(Judge, ErrorsAreFewerOnceTheObjectIsKnown) {
  auto takes = test::made_takes({.people = 6, .trials = 4, .noise = 0.03});
  Random random(4);
  for (Take& take : takes)
    take.object = ball((take.label == "cup" ? 0.02 : 0.04) * std::exp(random.normal(0.1)));
  const auto results = judge(
      takes, nullptr, {}, 1, [](std::size_t, std::size_t) {}, true);
  ASSERT_EQ(results.size(), 1u);
  ASSERT_FALSE(results[0].trouble);
  const double without = accuracy(results[0].methods.at(Method::posture));
  EXPECT_LT(without, 0.97) << "or there is nothing to mend";
  const auto& told = results[0].with_object.at(Method::posture);
  EXPECT_EQ(told.size(), takes.size());
  EXPECT_GT(accuracy(told), without);
}

TEST(Judge, SaysWhatIsMissingWhereNoObjectIsKnown) {
  const auto takes = test::made_takes({.people = 3, .trials = 2});
  const auto results = judge(
      takes, nullptr, {}, 1, [](std::size_t, std::size_t) {}, true);
  ASSERT_TRUE(results[0].trouble);
  EXPECT_NE(results[0].trouble->what.find("no object was measured"), std::string::npos);
}

}  // namespace
}  // namespace prehend::demonstration
