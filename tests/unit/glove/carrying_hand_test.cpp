// A person who carries something between both palms: both press it all the way, from the side at
// which they are, whatever its size and wherever it stands; smooth, and back again the next time.
#include "services/glove/core/carrying_hand.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/glove/core/mirrored_scene.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

const Pose X_WT_aside = make_pose(Vector3d(0.1, 0.45, 0.30));

struct Room {
  model::Catalogue catalogue;
  model::Scene scene;
};

/// A crate of that width, m, which is to be carried.
Room with_crate(double width, const Vector3d& carry_W) {
  model::CatalogueObject crate;
  crate.name = "Crate";
  crate.shape = {model::ShapeKind::box, Vector3d(width, 0.2, 0.2)};
  Room room{model::Catalogue({crate}), {}};
  room.scene.objects.push_back({"Crate", make_pose(Vector3d(0.05, -0.04, 0.1))});
  room.scene.demonstrator.target = "Crate";
  room.scene.demonstrator.carry_W = carry_W;
  room.scene.demonstrator.X_OG =
      make_pose(Vector3d(0.5 * width - 0.04, 0.01, 0.02),
                model::grasp_axes(-Vector3d::UnitX(), Vector3d::UnitY()));
  return room;
}

CarryingHand hand_of(const Room& room, bool left) {
  auto hand = CarryingHand::create(room.scene, room.catalogue,
                                   {.X_WT = X_WT_aside, .rate = 60, .left = left});
  if (!hand) throw std::runtime_error(hand.error().message());
  return std::move(*hand);
}

/// Where the palm's grasp frame is, m. A left hand is seen in the mirror.
Vector3d palm(const CarryingHand& hand, double time, bool left) {
  Vector3d p_W = (hand.hand(time).X_WH * model::HumanHand(1).X_HG()).translation();
  if (left) p_W.x() = 2 * X_WT_aside.translation().x() - p_W.x();
  return p_W;
}

TEST(CarryingHand, PressesFromBothSidesAllTheWay) {
  for (const double width : {0.25, 0.30, 0.45})
    for (const Vector3d& carry_W : {Vector3d(0.3, 0, 0), Vector3d(0, 0.2, 0)}) {
      const Room room = with_crate(width, carry_W);
      const CarryingHand right = hand_of(room, false), left = hand_of(room, true);
      const Vector3d stood = room.scene.objects[0].X_WO.translation();
      const double apart = width - 2 * (0.04 + 0.03);  // pressed by 30 mm each
      double highest = 0, farthest = 0;
      for (double t = 4.5; t < 10.6; t += 0.01) {  // from held to set down
        const Vector3d r = palm(right, t, false), l = palm(left, t, true);
        EXPECT_NEAR(r.x() - l.x(), apart, 1e-9) << t;
        EXPECT_NEAR((r - l).tail<2>().norm(), 0, 1e-9) << t;
        const Vector3d middle = (r + l) / 2 - stood - Vector3d(0, 0.01, 0);
        highest = std::max(highest, middle.z());
        farthest = std::max(farthest, middle.head<2>().norm());
      }
      EXPECT_NEAR(highest, 0.12 + 0.02, 1e-9);
      EXPECT_NEAR(farthest, carry_W.norm(), 1e-9);
      // The palms look at each other, and thumbs up.
      const Pose X_WG = right.hand(5).X_WH * model::HumanHand(1).X_HG();
      EXPECT_TRUE(X_WG.linear().col(2).isApprox(-Vector3d::UnitX()));
      EXPECT_GT(right.hand(5).X_WH.linear().col(1).z(), 0.9);
    }
}

// The left hand holds the tube out half-way, with its fingers around it, until the right hand has
// held it for a second; then it opens and goes, before the right one moves.
TEST(CarryingHand, HandsOverWhatBothHold) {
  model::CatalogueObject tube;
  tube.name = "Tube";
  tube.shape = {model::ShapeKind::cylinder, Vector3d(0.023, 0.023, 0.32)};
  Room room{model::Catalogue({tube}), {}};
  const Vector3d stood(-0.1, 0.03, 0.16);
  room.scene.objects.push_back({"Tube", make_pose(stood)});
  room.scene.demonstrator.target = "Tube";
  room.scene.demonstrator.carry_W = Vector3d(0.3, 0, 0);
  room.scene.demonstrator.hands_over = true;
  room.scene.demonstrator.X_OG =
      make_pose(Vector3d(0, 0, 0.08), model::grasp_axes(-Vector3d::UnitX(), -Vector3d::UnitY()));
  const CarryingHand giver = hand_of(room, true), taker = hand_of(room, false);
  const auto closed = [](const CarryingHand& hand, double t) {
    const auto closure = hand.hand(t).closure;
    return *std::max_element(closure.begin(), closure.end());
  };
  const double full = closed(giver, 7);
  EXPECT_GT(full, 0.2);
  double both = 0, last_given = 0, first_moved = 100;
  for (double t = 0; t < giver.cycle() + taker.cycle(); t += 0.01) {
    const Vector3d left = palm(giver, t, true), right = palm(taker, t, false);
    const bool gives = closed(giver, t) > 0.99 * full, takes = closed(taker, t) > 0.99 * full;
    if (gives) last_given = t;
    if (takes && right.x() > stood.x() + 0.151) first_moved = std::min(first_moved, t);
    if (!gives || !takes) continue;
    both += 0.01;
    EXPECT_NEAR((right - left - Vector3d(0, 0, 0.16)).norm(), 0, 1e-9) << t;
    EXPECT_NEAR((right - stood - Vector3d(0.15, 0, 0.08 + 0.12)).norm(), 0, 1e-9) << t;
  }
  EXPECT_GT(both, 1);
  EXPECT_GT(first_moved, last_given + 1);
  const Vector3d at_last = palm(taker, taker.cycle() - 3, false);
  EXPECT_NEAR(at_last.x() - stood.x(), 0.3, 1e-6);
  EXPECT_EQ(closed(taker, 100), 0);
  EXPECT_TRUE(palm(giver, 100, true).isApprox(palm(giver, giver.cycle(), true)));
}

TEST(CarryingHand, IsSmoothAndComesBack) {
  const Room room = with_crate(0.3, {0.3, 0, 0});
  const CarryingHand hand = hand_of(room, false);
  const double cycle = hand.cycle();
  for (double t = 0; t < 2 * cycle; t += 0.005)
    EXPECT_LT((palm(hand, t + 0.005, false) - palm(hand, t, false)).norm(), 0.005 * 0.6) << t;
  EXPECT_LT((palm(hand, 2 * cycle, false) - palm(hand, 0, false)).norm(), 1e-6);
  EXPECT_NEAR((palm(hand, cycle, false) - palm(hand, 0, false)).x(), 0.3, 1e-6);
}

TEST(CarryingHand, FramesOfALeftHandSayThatTheyAreMirrored) {
  const Room room = with_crate(0.3, {0.3, 0, 0});
  EXPECT_TRUE(hand_of(room, true).frame(7)->left);
  EXPECT_FALSE(hand_of(room, false).frame(7)->left);
  Room empty = room;
  empty.scene.objects.clear();
  EXPECT_FALSE(CarryingHand::create(empty.scene, empty.catalogue, {.X_WT = X_WT_aside}));
}

TEST(MirroredScene, IsTheSameAgainInTheMirror) {
  model::Scene scene = with_crate(0.3, {0.3, 0.1, 0}).scene;
  scene.objects[0].X_WO =
      make_pose({0.2, 0.1, 0.1}, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d::UnitZ())));
  const model::Scene once = mirrored(scene, X_WT_aside), twice = mirrored(once, X_WT_aside);
  EXPECT_NEAR(once.objects[0].X_WO.translation().x(), 0, 1e-12);
  EXPECT_NEAR(once.objects[0].X_WO.linear().determinant(), 1, 1e-12);
  EXPECT_TRUE(twice.objects[0].X_WO.isApprox(scene.objects[0].X_WO));
  EXPECT_TRUE(twice.demonstrator.carry_W.isApprox(scene.demonstrator.carry_W));
  EXPECT_NEAR(twice.demonstrator.grasp_yaw, scene.demonstrator.grasp_yaw, 1e-12);
}

}  // namespace
}  // namespace prehend::glove
