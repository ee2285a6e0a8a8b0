// What is planned for: what stands and is seen, once for all that is alike, the least searched
// first; and what is told of it.
#include "services/planner/core/plan_book.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/base/paths.hpp"
#include "tests/support/hands.hpp"

namespace prehend::planner {
namespace {

using testing::HasSubstr;

const model::Catalogue& objects() {
  static const model::Catalogue catalogue =
      model::Catalogue::load(share_directory() / "models/objects/catalogue.toml").value();
  return catalogue;
}

const grasping::CatalogueBodies& bodies() {
  static const auto made = grasping::CatalogueBodies::create(objects()).value();
  return made;
}

model::Detection seen(std::uint32_t track, const std::string& name, double larger = 1) {
  model::Detection made;
  made.track = track;
  made.name = name;
  made.shape = objects().find(name)->shape;
  made.shape.size *= larger;
  made.probability = 0.9;
  made.stamp = Time(seconds(1));
  return made;
}

void in_turn(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

/// Searches one round of what is next.
std::string round(PlanBook& book) {
  const auto work = book.next();
  if (!work) return "";
  book.searched(*work, work->search->try_next(in_turn));
  return work->object;
}

PlanBookOptions brief() {
  PlanBookOptions options;
  options.search.attempts = 2;
  options.search.at_once = 1;
  return options;
}

class PlanBookTest : public testing::Test {
 protected:
  const model::HandModel& hand = test::hand("parallel_jaw");
  PlanBook book{hand, bodies(), {}, brief()};
};

TEST_F(PlanBookTest, SearchesUntilAllIsFoundAndTellsWhatIsNew) {
  ASSERT_TRUE(book.observe(seen(3, "Wood cube")));
  int rounds = 0;
  std::vector<TrackPlan> told;
  while (!round(book).empty()) {
    ++rounds;
    for (TrackPlan& news : book.news()) told.push_back(std::move(news));
    EXPECT_TRUE(book.news().empty()) << "told once";
  }
  // An attempt, its judgement, and whether fingers go on.
  EXPECT_GE(rounds, 1);
  EXPECT_LE(rounds, 3);
  ASSERT_FALSE(told.empty());
  const Plan& last = told.back().plan;
  EXPECT_TRUE(last.complete);
  EXPECT_EQ(told.back().seen.track, 3u);
  ASSERT_FALSE(last.grasps.empty()) << last.reason;
  EXPECT_GT(last.grasps.front().room, 0.3);
  EXPECT_EQ(last.object.mass, objects().find("Wood cube")->mass);
}

TEST_F(PlanBookTest, WhatIsAlikeSharesAPlan) {
  ASSERT_TRUE(book.observe(seen(1, "Wood cube")));
  ASSERT_TRUE(book.observe(seen(2, "Wood cube", 1.01)));
  while (!round(book).empty()) {
  }
  const auto told = book.news();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].plan.grasps.size(), told[1].plan.grasps.size());
}

TEST_F(PlanBookTest, ASizeThatTremblesIsPlannedForOnceAndAnotherOneAnew) {
  ASSERT_TRUE(book.observe(seen(1, "Vitamins")));
  const std::string first = book.next()->object;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(book.observe(seen(1, "Vitamins", i % 2 == 0 ? 0.99 : 1.01)));
    EXPECT_EQ(book.next()->object, first);
  }
  ASSERT_TRUE(book.observe(seen(1, "Vitamins", 1.2)));
  EXPECT_NE(book.next()->object, first);
}

TEST_F(PlanBookTest, TheLeastSearchedIsNext) {
  ASSERT_TRUE(book.observe(seen(1, "Uncle Ben's")));
  ASSERT_TRUE(book.observe(seen(2, "Vitamins")));
  const std::string first = round(book);
  EXPECT_NE(round(book), first);
}

TEST_F(PlanBookTest, WhatIsGoneIsNeitherSearchedNorTold) {
  ASSERT_TRUE(book.observe(seen(1, "Wood cube")));
  const auto work = book.next();
  ASSERT_TRUE(work);
  book.remove(1);
  book.searched(*work, false);
  EXPECT_TRUE(book.news().empty());
  EXPECT_FALSE(book.next());
}

TEST_F(PlanBookTest, RefusesWhatCannotBePlannedFor) {
  const auto refused = [&](model::Detection object) {
    const auto taken = book.observe(object);
    return taken ? std::string("taken") : taken.error().what;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  model::Detection object = seen(1, "Wood cube");
  object.X_WO.translation().x() = nan;
  EXPECT_EQ(refused(object), "pose of a detection not finite");
  object = seen(1, "Wood cube");
  object.shape.size.y() = nan;
  EXPECT_EQ(refused(object), "detection without a shape");
  object.shape.size.y() = 1e-9;
  EXPECT_EQ(refused(object), "detection without a shape");
  object = seen(1, "Wood cube");
  object.shape.kind = model::ShapeKind::unknown;
  EXPECT_EQ(refused(object), "detection without a shape");
  object = seen(1, "Wood cube");
  object.probability = nan;
  EXPECT_EQ(refused(object), "detection not probable");
  object = seen(1, "Wood cube");
  object.X_WO.linear() = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_EQ(refused(object), "object does not stand");
  EXPECT_EQ(refused(seen(1, "Wood cube")), "taken");
  object = seen(1, "Wood cube");
  object.stamp = Time(seconds(0.5));
  EXPECT_EQ(refused(object), "detection out of order");
  EXPECT_TRUE(book.next());
}

TEST_F(PlanBookTest, WhatNeverFitsIsSaid) {
  model::Detection wall = seen(1, "Wood cube");
  wall.name = "wall";
  wall.shape.size.setConstant(0.6);
  ASSERT_TRUE(book.observe(wall));
  while (!round(book).empty()) {
  }
  const auto told = book.news();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].plan.complete);
  EXPECT_THAT(told[0].plan.reason, HasSubstr("does not fit"));
  EXPECT_LE(told[0].plan.object.mass, 0.6) << "in no catalogue: estimated";
}

TEST(PlanBookStore, APlanThatIsKeptIsNotSearchedAgain) {
  const model::HandModel& hand = test::hand("parallel_jaw");
  std::vector<Plan> kept;
  const PlanStore store{[&](const grasping::Body& object) -> std::optional<Plan> {
                          for (const Plan& plan : kept)
                            if (plan.object.shape == object.shape) return plan;
                          return std::nullopt;
                        },
                        [&](const Plan& plan) { kept.push_back(plan); }};
  PlanBook first(hand, bodies(), store, brief());
  ASSERT_TRUE(first.observe(seen(1, "Wood cube")));
  while (!round(first).empty()) {
  }
  ASSERT_EQ(kept.size(), 1u);
  PlanBook second(hand, bodies(), store, brief());
  ASSERT_TRUE(second.observe(seen(7, "Wood cube")));
  EXPECT_FALSE(second.next());
  const auto told = second.news();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].seen.track, 7u);
  EXPECT_TRUE(told[0].plan.complete);
  EXPECT_EQ(told[0].plan.grasps.size(), kept[0].grasps.size());
}

// A lab may run for weeks, and a camera see anything.
TEST_F(PlanBookTest, DoesNotGrowWithoutEnd) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    model::Detection object = seen(i, "Wood cube");
    object.name = "thing";
    object.shape.size = Eigen::Vector3d(0.01 + 1e-3 * (i % 90), 0.02 + 1e-3 * (i / 90), 0.05);
    ASSERT_TRUE(book.observe(object));
    if (i % 2 == 0) book.remove(i);
  }
  model::Detection late = seen(5000, "Wood cube");
  for (std::uint32_t track = 5000; track < 5600; ++track) {
    late.track = track;
    (void)book.observe(late);
  }
  late.track = 9999;
  const auto taken = book.observe(late);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().what, "too many objects");
}

}  // namespace
}  // namespace prehend::planner
