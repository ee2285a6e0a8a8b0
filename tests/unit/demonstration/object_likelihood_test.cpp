#include "services/demonstration/core/recognition/object_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.hpp"
#include "services/demonstration/tools/evaluation/trial.hpp"
#include "tests/support/takes/made_takes.hpp"

namespace prehend::demonstration {
namespace {

using model::ShapeKind;

/// A hand whose thumb and fingers are so far apart.
HandSample apart(double distance) {
  HandSample made;
  for (std::size_t f = 0; f < made.p_thumb_tip_W.size(); ++f)
    made.p_thumb_tip_W[f] = {distance, 0.02 * static_cast<double>(f), 0.001};
  return made;
}

model::Shape ball(double radius) {
  return {ShapeKind::sphere, Eigen::Vector3d::Constant(radius)};
}

/// Fingertips stand on balls («on») or around them, beyond their middle («around»); balls are of
/// the same sizes.
std::vector<Take> balls(Random& random, int count) {
  std::vector<Take> made;
  for (int n = 0; n < count; ++n) {
    const double radius = random.uniform(0.02, 0.05);
    const bool on = n % 2 == 0;
    Take take{.user = "1", .task = "1", .label = on ? "on" : "around"};
    take.samples.push_back(apart(radius * (on ? 2 : 1.2) * std::exp(random.normal(0.05))));
    take.object = ball(radius);
    made.push_back(take);
  }
  return made;
}

std::vector<const Take*> each_of(const std::vector<Take>& takes) {
  std::vector<const Take*> made;
  for (const Take& take : takes) made.push_back(&take);
  return made;
}

TEST(ObjectLikelihood, OfAnObjectAloneIsHowOftenAndOfWhichSize) {
  Random random(1);
  std::vector<Take> takes;
  for (int n = 0; n < 40; ++n) {
    takes.push_back({.label = n % 2 == 0 ? "small" : "large", .samples = {apart(0.05)}});
    takes.back().object = ball(std::exp(random.normal(0.1)) * (n % 2 == 0 ? 0.01 : 0.05));
  }
  const auto made =
      ObjectLikelihood::learn(each_of(takes), {"large", "never", "small"}, Beside::nothing);
  ASSERT_TRUE(made) << made.error().message();
  const Eigen::VectorXd p = made->of(ball(0.011), apart(0.05));
  EXPECT_GT(p[2], 20 * p[0]);
  EXPECT_GT(p.minCoeff(), 0) << "nothing is impossible";
  const Eigen::VectorXd box = made->of({ShapeKind::box, {0.02, 0.03, 0.05}}, apart(0.05));
  EXPECT_NEAR(box[0], box[2], 1e-12) << "nobody grasped one";
}

TEST(ObjectLikelihood, BesideAHandTellsKindsThatGoWithTheSameObjects) {
  Random random(2);
  const auto takes = balls(random, 100), others = balls(random, 100);
  const auto right = [&](Beside beside) {
    const auto made = ObjectLikelihood::learn(each_of(takes), {"around", "on"}, beside);
    int count = 0;
    for (const Take& take : others) {
      const Eigen::VectorXd p = made->of(*take.object, take.samples.back());
      count += (p[1] > p[0]) == (take.label == "on");
    }
    return count;
  };
  EXPECT_GE(right(Beside::hand), 97);
  EXPECT_LE(right(Beside::nothing), 70);
}

TEST(ObjectLikelihood, NeedsObjectsAndBearsFewTakesAndUnknownNumbers) {
  Random random(3);
  auto takes = balls(random, 6);
  takes[0].samples[0].p_thumb_tip_W[2].setConstant(unknown_number);
  const auto few = ObjectLikelihood::learn(each_of(takes), {"around", "on"}, Beside::hand);
  ASSERT_TRUE(few);
  const Eigen::VectorXd p = few->of(ball(0.03), takes[0].samples[0]);
  EXPECT_TRUE(p.allFinite());
  EXPECT_GT(p.minCoeff(), 0);
  for (Take& take : takes) take.object.reset();
  const auto none = ObjectLikelihood::learn(each_of(takes), {"around", "on"}, Beside::hand);
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
  for (const auto& [beside, answers] : results[0].with_object) {
    EXPECT_EQ(answers.at(Method::posture).size(), takes.size());
    EXPECT_GT(accuracy(answers.at(Method::posture)), without);
  }
  EXPECT_EQ(results[0].with_object.size(), 2u);
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
