// People who do not exist grasp as the taxonomy says: fingertips on the object where it is held by
// them, fingers around it where it lies in the palm; each has a hand of his own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/random.hpp"
#include "services/demonstration/core/showing/holding.hpp"
#include "services/demonstration/core/showing/objects.hpp"
#include "services/demonstration/core/showing/people.hpp"
#include "services/demonstration/files/takes_file.hpp"

namespace prehend::demonstration {
namespace {

using model::Finger;

const model::GraspTaxonomy& taxonomy() {
  static const auto made = model::GraspTaxonomy::of_the_house().value();
  return made;
}

/// Distance of each fingertip that takes part from the object's surface, m.
std::vector<double> distances(const model::HumanHand& hand, const model::GraspClass& kind,
                              const model::Shape& shape, const Held& held) {
  std::vector<double> made;
  const auto tips = hand.fingertip_poses(held.posture);
  for (int f = 0; f < model::finger_count; ++f)
    if (takes_part(kind, static_cast<Finger>(f)))
      made.push_back(model::signed_distance(
          shape, held.X_HO.inverse() * tips[static_cast<std::size_t>(f)].translation()));
  return made;
}

double deepest(const model::HumanHand& hand, const model::Shape& shape, const Held& held) {
  double made = 0;
  for (const model::Capsule& segment : hand.segments(held.posture))
    for (int i = 0; i <= 10; ++i) {
      const Eigen::Vector3d p_H = segment.a + (segment.b - segment.a) * i / 10;
      made =
          std::max(made, segment.radius - model::signed_distance(shape, held.X_HO.inverse() * p_H));
    }
  return made;
}

TEST(Holding, WhatIsHeldIsTurnedAndNotDistorted) {
  Random random(2);
  for (const model::GraspClass& kind : taxonomy().classes()) {
    const model::Shape shape = drawn_object(kind, random);
    const Held held = holding(model::HumanHand(1), kind, shape, {});
    const Eigen::Matrix3d R = held.X_HO.linear();
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9) << kind.name;
    EXPECT_NEAR(R.determinant(), 1, 1e-9) << kind.name;
  }
}

TEST(Holding, FingertipsLieOnWhatTheyHold) {
  Random random(3);
  for (const char* name : {"precision sphere", "tripod", "thumb-4 finger", "thumb-index finger",
                           "power sphere", "power disk"}) {
    const model::GraspClass& kind = *taxonomy().find(name);
    int tips = 0, there = 0;
    for (int n = 0; n < 40; ++n) {
      const model::HumanHand hand(random.uniform(0.9, 1.1));
      const model::Shape shape = drawn_object(kind, random);
      for (const double distance : distances(hand, kind, shape, holding(hand, kind, shape, {}))) {
        ++tips;
        there += std::abs(distance - 0.006 * hand.scale()) < 0.005;
      }
    }
    EXPECT_GE(there, 0.85 * tips) << name << ": a few objects are too large for a hand";
  }
}

TEST(Holding, FingersWrapWhatLiesInThePalmAndDoNotPassThroughIt) {
  Random random(4);
  for (const char* name : {"large diameter", "medium wrap", "small diameter"}) {
    const model::GraspClass& kind = *taxonomy().find(name);
    for (int n = 0; n < 20; ++n) {
      const model::HumanHand hand(random.uniform(0.9, 1.1));
      const model::Shape shape = drawn_object(kind, random);
      const Held held = holding(hand, kind, shape, {});
      EXPECT_LT(deepest(hand, shape, held), 0.016) << name << " " << shape.size.transpose();
      const double open = (hand.fingertip_poses(model::HumanHand::open_posture())[2].translation() -
                           hand.fingertip_poses(held.posture)[2].translation())
                              .norm();
      EXPECT_GT(open, 0.01) << name << ": the middle finger has closed";
    }
  }
}

TEST(Holding, TheThumbPressesOnTheSideOfTheIndexFinger) {
  Random random(5);
  const model::GraspClass& kind = *taxonomy().find("lateral pinch");
  int there = 0;
  for (int n = 0; n < 40; ++n) {
    const model::HumanHand hand(random.uniform(0.9, 1.1));
    const model::Shape shape = drawn_object(kind, random);
    const Held held = holding(hand, kind, shape, {});
    const auto tips = hand.fingertip_poses(held.posture);
    const double thumb = model::signed_distance(shape, held.X_HO.inverse() * tips[0].translation());
    there += std::abs(thumb - 0.006 * hand.scale()) < 0.005;
    EXPECT_GT(tips[0].translation().y(), tips[1].translation().y()) << "from the outside";
  }
  EXPECT_GE(there, 36);
}

TEST(DrawnObjects, AreOfTheShapesAndWidthsThatTheTaxonomySays) {
  Random random(6);
  for (const model::GraspClass& kind : taxonomy().classes())
    for (int n = 0; n < 50; ++n) {
      const model::Shape shape = drawn_object(kind, random);
      ASSERT_TRUE(model::is_valid(shape));
      EXPECT_NE(std::find(kind.shapes.begin(), kind.shapes.end(), shape.kind), kind.shapes.end());
      const double width = 2 * model::half_extents(shape).x();
      EXPECT_GE(width, kind.min_width - 1e-9) << kind.name;
      EXPECT_LE(width, kind.max_width + 1e-9) << kind.name;
    }
}

TEST(DrawnTakes, AreOfAllKindsAndOfPeopleWhoDiffer) {
  const auto made = drawn_takes(taxonomy(), {.people = 3, .trials = 2, .seed = 7});
  ASSERT_TRUE(made) << made.error().message();
  ASSERT_EQ(made->size(), 3 * 2 * measured_kinds.size());
  std::set<std::string> people, kinds;
  for (const Take& take : *made) {
    people.insert(take.user);
    kinds.insert(take.label);
    ASSERT_TRUE(take.object) << take.label;
    ASSERT_GE(take.samples.size(), 2u);
    for (const HandSample& sample : take.samples)
      for (const Eigen::Vector3d& tip : sample.p_thumb_tip_W) {
        EXPECT_TRUE(tip.allFinite());
        EXPECT_LT(tip.norm(), 0.3);
      }
  }
  EXPECT_EQ(people.size(), 3u);
  EXPECT_EQ(kinds.size(), measured_kinds.size());
}

TEST(DrawnTakes, AreTheSameForASeedAndOtherPeopleForAnother) {
  const auto csv = [](std::uint64_t seed) {
    return takes_csv(drawn_takes(taxonomy(), {.people = 1, .trials = 1, .seed = seed}).value());
  };
  EXPECT_EQ(csv(1), csv(1));
  EXPECT_NE(csv(1), csv(2));
}

TEST(DrawnTakes, ThumbAndIndexAreAsFarApartAsTheObjectIsWide) {
  const auto made = drawn_takes(taxonomy(), {.people = 30, .trials = 4, .seed = 8}).value();
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (const Take& take : made) {
    if (take.label != "precision sphere") continue;
    const double width = 2 * model::half_extents(*take.object).x();
    const double apart = take.samples.back().p_thumb_tip_W[0].norm();
    n += 1, x += width, y += apart, xx += width * width, yy += apart * apart, xy += width * apart;
  }
  EXPECT_GT((n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y)), 0.8);
}

TEST(DrawnTakes, NeedTheirKindsInTheTaxonomy) {
  EXPECT_EQ(drawn_takes(model::GraspTaxonomy(), {}).error().message(),
            "large diameter: is not in the taxonomy");
}

TEST(DrawnTakes, AreReadAsTheyWereWritten) {
  const auto made = drawn_takes(taxonomy(), {.people = 2, .trials = 1, .seed = 9}).value();
  const auto read = parse_takes(takes_csv(made), "task_kinds.csv", "_kinds");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(read->complaints.empty());
  ASSERT_EQ(read->takes.size(), made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    const Take &one = read->takes[i], &other = made[i];
    EXPECT_EQ(one.label, other.label);
    EXPECT_EQ(one.user, other.user);
    EXPECT_EQ(one.task, "kinds");
    ASSERT_TRUE(one.object);
    EXPECT_EQ(one.object->kind, other.object->kind);
    EXPECT_TRUE(one.object->size.isApprox(other.object->size, 1e-3));
    ASSERT_EQ(one.samples.size(), other.samples.size());
    for (std::size_t f = 0; f < 4; ++f)
      EXPECT_LT((one.samples[1].p_thumb_tip_W[f] - other.samples[1].p_thumb_tip_W[f]).norm(), 2e-5);
    for (std::size_t f = 0; f < one.samples[1].p_HF.size(); ++f)
      EXPECT_LT((one.samples[1].p_HF[f] - other.samples[1].p_HF[f]).norm(), 2e-5);
    EXPECT_NEAR(one.samples[1].scale, other.samples[1].scale, 1e-4);
  }
}

}  // namespace
}  // namespace prehend::demonstration
