// Which object a hand reaches for, for every hand, among objects that stand anywhere: the nearest
// grasp within the limits, and the same object until it is left or another is clearly nearer. What
// is compared is found by the same formulas on both sides, so nothing needs a tolerance but 1e-12
// for the product of two poses.
#include "services/mapping/core/target_selector.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "common/model/placement.hpp"
#include "services/mapping/core/palm_offset.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

Pose coming_from_the_side(const Eigen::Vector3d& p) {
  Eigen::Matrix3d R;
  R << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  return make_pose(p, R);
}

Detection standing(std::uint32_t track, const model::Shape& shape, double x, double y) {
  return {track, "object", shape, make_pose({x, y, half_extents(shape).z()}), 0.9, Time{}};
}

/// Distance and angle to the object's nearest grasp.
struct Way {
  double distance = 0, angle = 0;
};
std::optional<Way> way_to(const Detection& object, const Pose& X_WG, const model::Reach& reach) {
  const auto X_OG = model::nearest_grasp(object.shape, object.X_WO.inverse() * X_WG, reach);
  if (!X_OG) return std::nullopt;
  const Pose X_WG_grasp = object.X_WO * *X_OG;
  return Way{(X_WG_grasp.translation() - X_WG.translation()).norm(),
             angle_between(X_WG_grasp.linear(), X_WG.linear())};
}

class TargetSelectorOf : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  MappingModel model_ = random_model(5, hand_);  // of networks for cylinders and boxes
  TargetOptions options_;
  TargetSelector selector_{hand_, model_, options_};
};

TEST_P(TargetSelectorOf, TakesTheNearestWithinReachAndThenStaysWithIt) {
  const model::Shape shapes[]{{model::ShapeKind::cylinder, {0.02, 0.02, 0.15}},
                              {model::ShapeKind::box, {0.04, 0.05, 0.2}},
                              {model::ShapeKind::sphere, {0.02, 0.02, 0.02}},
                              {model::ShapeKind::cone, {0.03, 0.02, 0.15}}};
  Random random(1);
  int chosen = 0, none = 0, kept = 0, left = 0, given_up = 0;
  for (int run = 0; run < 600; ++run) {
    ObjectTracks tracks({});
    for (std::uint32_t track = 0; track < 3; ++track)
      ASSERT_TRUE(tracks.observe(standing(track, shapes[random.index(4)], random.uniform(-0.3, 0.3),
                                          random.uniform(-0.3, 0.3))));
    const Pose X_WG = coming_from_the_side({0, 0, random.uniform(0.05, 0.2)}) *
                      Eigen::AngleAxisd(random.normal(0.4), Eigen::Vector3d::UnitX());
    std::map<std::uint32_t, Way> ways;
    for (const auto& [number, track] : tracks.known())
      if (const auto way = way_to(track.detection, X_WG, hand_.reach())) ways[number] = *way;
    const auto in_reach = [&](std::uint32_t number, double distance, double angle) {
      return ways.contains(number) && ways.at(number).distance <= distance &&
             ways.at(number).angle <= angle;
    };
    // Nothing is reached for: the nearest one that can be entered.
    TargetSelector fresh = selector_;
    const auto first = fresh.select(tracks, {}, X_WG);
    std::optional<std::uint32_t> nearest;
    for (const auto& [number, way] : ways)
      if (in_reach(number, options_.enter, options_.enter_angle) &&
          (!nearest || way.distance < ways.at(*nearest).distance))
        nearest = number;
    ASSERT_EQ(first.has_value(), nearest.has_value());
    if (first) {
      ASSERT_EQ(first->object.detection.track, *nearest);
      EXPECT_TRUE(first->X_WG.isApprox(first->object.detection.X_WO * first->X_OG, 1e-12));
      EXPECT_EQ(first->distance, ways.at(*nearest).distance);
    }
    (first ? chosen : none) += 1;
    // Each of them in turn is reached for.
    for (const std::uint32_t engaged : {0u, 1u, 2u}) {
      TargetSelector busy = selector_;
      busy.update(GraspTarget{tracks.known().at(engaged)}, Phase::direct, Phase::engaging);
      const auto again = busy.select(tracks, {}, X_WG);
      bool another = false;
      for (const auto& [number, way] : ways)
        another = another || (number != engaged && ways.contains(engaged) &&
                              in_reach(number, options_.enter, options_.enter_angle) &&
                              way.distance < ways.at(engaged).distance - options_.prefer);
      const bool stays = in_reach(engaged, options_.leave, options_.leave_angle) && !another;
      ASSERT_EQ(again.has_value(), stays);
      if (again) {
        ASSERT_EQ(again->object.detection.track, engaged);
      }
      (stays ? kept : another ? given_up : left) += 1;
    }
  }
  // All that can happen has happened.
  for (const int count : {chosen, none, kept, left, given_up}) EXPECT_GT(count, 5);
}

INSTANTIATE_TEST_SUITE_P(Hands, TargetSelectorOf, testing::ValuesIn(test::hand_names()));

TEST(TargetSelectorTest, WhatNoNetworkKnowsNorAnythingLikeItIsNoTarget) {
  const MappingModel direct = *MappingModel::create(barrett(), plain_traits(barrett()),
                                                    {random_network(model::ShapeKind::unknown, 1)});
  const TargetOptions options;
  for (const bool knows : {true, false}) {
    const MappingModel model = knows ? random_model(5) : direct;
    for (const model::Shape& shape : {model::Shape{model::ShapeKind::cylinder, {0.03, 0.03, 0.15}},
                                      model::Shape{model::ShapeKind::cone, {0.02, 0.04, 0.15}}}) {
      ObjectTracks tracks({});
      ASSERT_TRUE(tracks.observe(standing(1, shape, 0, 0)));
      const auto target = TargetSelector(barrett(), model, options)
                              .select(tracks, {}, coming_from_the_side({0, 0, 0.08}));
      EXPECT_EQ(target.has_value(), knows) << model::to_string(shape.kind);
    }
  }
}

TEST(TargetSelectorTest, SaysWhereTheHandStands) {
  const model::Shape talc{model::ShapeKind::cylinder, {0.024, 0.024, 0.105}};
  const MappingModel plain = random_model(5);
  ModelTraits traits = plain.traits();
  traits.places = {{model::ShapeKind::cylinder, {0.05, 0.05, 0.1, 0}, {0, -0.012, 0.01}}};
  const auto model = MappingModel::create(barrett(), traits, plain.networks());
  ASSERT_TRUE(model);
  ObjectTracks tracks({});
  ASSERT_TRUE(tracks.observe(standing(1, talc, 0, 0)));
  const auto target =
      TargetSelector(barrett(), *model, {}).select(tracks, {}, coming_from_the_side({0, 0, 0.06}));
  ASSERT_TRUE(target);
  EXPECT_EQ(target->X_GR.translation(), place_for(traits.places, talc, target->X_OG));
  EXPECT_NEAR(target->X_GR.translation().y(), -0.012, 1e-12);  // a single place is its own mean
}

TEST(TargetSelectorTest, AGripKeepsItsObjectAsItWasSeenLast) {
  const MappingModel model = random_model(5);
  TargetSelector selector(barrett(), model, {});
  GraspTarget seen;
  const auto at = [&](double distance) {
    seen.distance = distance;
    return seen;
  };
  EXPECT_FALSE(selector.engaged());
  selector.update(at(0.1), Phase::direct, Phase::engaging);
  EXPECT_EQ(selector.engaged()->distance, 0.1);
  selector.update(at(0.2), Phase::engaged, Phase::engaged);
  EXPECT_EQ(selector.engaged()->distance, 0.2);
  selector.update(std::nullopt, Phase::engaged, Phase::leaving);
  EXPECT_EQ(selector.engaged()->distance, 0.2) << "its weight has not gone to 0 yet";
  selector.update(at(0.3), Phase::gripping, Phase::gripping);
  EXPECT_EQ(selector.engaged()->distance, 0.2);
  selector.update(std::nullopt, Phase::leaving, Phase::direct);
  EXPECT_FALSE(selector.engaged());
}

}  // namespace
}  // namespace prehend::mapping
