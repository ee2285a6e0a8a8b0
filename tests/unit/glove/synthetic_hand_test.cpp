// The synthetic hand over all shapes that a hand can grasp: finite, orthonormal, in order, smooth,
// the same each time, and really reaching for the object where the scene says it stands.
#include "services/glove/core/synthetic_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/model/placement.hpp"
#include "services/glove/core/mirrored_scene.hpp"
#include "services/glove/core/processor.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

model::Catalogue catalogue() {
  const auto loaded =
      model::Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().message());
  return loaded.value_or(model::Catalogue{});
}

model::Scene scene_with(const model::CatalogueObject& object, double yaw = 0.4) {
  model::Scene scene;
  const double height = 0.5 * object.shape.size.z();
  scene.objects.push_back(
      {object.name, make_pose(Vector3d(0.05, -0.04, height),
                              Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())))});
  scene.demonstrator.target = object.name;
  scene.demonstrator.grasp_yaw = -1.2;
  scene.demonstrator.approach_offset = {0.004, -0.006, 0.003};
  scene.demonstrator.approach_turn = {0.03, -0.05, 0.02};
  return scene;
}

const Pose X_WT = make_pose(Vector3d(0, 0.45, 0.30));

class EveryObject : public testing::Test {
 protected:
  const model::Catalogue known = catalogue();
};

TEST_F(EveryObject, GivesFiniteFramesInOrder) {
  for (const auto& object : known.objects()) {
    const auto hand = SyntheticHand::create(scene_with(object), known, {.X_WT = X_WT, .rate = 30});
    ASSERT_TRUE(hand) << hand.error().message();
    std::optional<Time> last;
    for (std::uint64_t n = 0; n < 330; ++n) {
      const auto frame = hand->frame(n);
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->sequence, n);
      if (last) {
        EXPECT_GT(frame->stamp, *last);
      }
      last = frame->stamp;
      ASSERT_EQ(frame->readings.size(), 4u);
      for (const Reading& reading : frame->readings) {
        EXPECT_TRUE(reading.p_TS.allFinite());
        EXPECT_NEAR(reading.q_TS.norm(), 1, 1e-9);
        // Within the tracker's 72 inch range, extreme points apart.
        EXPECT_LT(reading.p_TS.cwiseAbs().maxCoeff(), 1.8288);
      }
    }
  }
}

TEST_F(EveryObject, GraspsWhereTheObjectStands) {
  for (const auto& object : known.objects())
    for (const auto& [yaw, left] :
         {std::pair(0.0, false), {0.4, false}, {0.4, true}, {1.5, false}, {3.0, false}}) {
      const model::Scene room = scene_with(object, yaw);
      const auto hand = SyntheticHand::create(room, known, {.X_WT = X_WT, .left = left});
      ASSERT_TRUE(hand) << hand.error().message();
      // A left hand does there what a right one does in the mirror.
      const model::Scene scene = left ? mirrored(room, X_WT) : room;
      const Pose X_OG = scene.objects[0].X_WO.inverse() * hand->grasp() * hand->model().X_HG();
      const auto nearest = model::nearest_grasp(object.shape, X_OG, model::Reach{});
      ASSERT_TRUE(nearest);
      // Only the demonstrator's errors, 8 mm and 0.06 rad, lie between it and a perfect grasp;
      // along a box's side both may be away from the middle.
      EXPECT_LT((X_OG.translation() - nearest->translation()).norm(), 0.009) << object.name;
      EXPECT_LT(angle_between(X_OG.linear(), nearest->linear()), 0.07) << object.name;
      // The thumb and at least two fingers stop on the object.
      const HandState closed = hand->hand(5.5);
      int touching = 0;
      for (std::size_t f = 1; f < model::finger_count; ++f)
        touching += closed.closure[f] > 0 && closed.closure[f] < 0.999;
      EXPECT_GE(touching, 2) << object.name << ' ' << yaw;
      EXPECT_GT(closed.closure[0], 0) << object.name << ' ' << yaw;
    }
}

// Also where it grasps from above: a hand that waits there would hide the object, and knock it over
// as it comes.
TEST_F(EveryObject, RestsBesideIt) {
  for (const auto& object : known.objects()) {
    const auto hand = SyntheticHand::create(scene_with(object), known, {.X_WT = X_WT});
    ASSERT_TRUE(hand) << hand.error().message();
    const Vector3d away = hand->hand(0).X_WH.translation() - hand->grasp().translation();
    EXPECT_NEAR(away.head<2>().norm(), 0.25, 1e-6) << object.name;
  }
}

// The person used to reach as deep as a human hand can: longer robot fingers met the table.
TEST_F(EveryObject, LeavesTheHandThatIsLedItsRoom) {
  int above = 0, beside = 0;
  for (const auto& object : known.objects()) {
    model::Scene scene = scene_with(object);
    scene.demonstrator.reach.clearance = 0.13;
    scene.demonstrator.reach.half_width = 0.07;
    const auto hand = SyntheticHand::create(scene, known, {.X_WT = X_WT});
    // What is low can be had from nowhere.
    if (!hand) {
      EXPECT_LT(object.shape.size.z(), 0.105) << object.name;
      continue;
    }
    const Pose X_WG = hand->grasp() * hand->model().X_HG();
    const bool from_above = X_WG.linear()(2, 2) < -0.7;
    (from_above ? above : beside) += 1;
    EXPECT_GT(X_WG.translation().z(), (from_above ? 0.13 : 0.07) - 0.009) << object.name;
    // A box that is too low for the way from above is taken from the person's own side.
    const Vector3d toward(-std::cos(-1.2), -std::sin(-1.2), 0);
    if (!from_above) {
      EXPECT_GT(X_WG.linear().col(2).dot(toward), 0) << object.name;
    }
  }
  EXPECT_GT(above, 0);
  EXPECT_GT(beside, 0);
}

TEST_F(EveryObject, MovesSmoothlyAndStaysAboveTheTable) {
  for (const auto& object : known.objects()) {
    const auto hand = SyntheticHand::create(scene_with(object), known, {.X_WT = X_WT});
    ASSERT_TRUE(hand);
    constexpr double dt = 0.001;
    HandState last = hand->hand(0);
    double fastest = 0, lowest = 1, highest = -1;
    for (double t = dt; t < 2 * SyntheticHand::cycle(); t += dt) {
      const HandState now = hand->hand(t);
      fastest = std::max(fastest, (now.X_WH.translation() - last.X_WH.translation()).norm() / dt);
      for (std::size_t f = 0; f < model::finger_count; ++f)
        ASSERT_LT(std::abs(now.closure[f] - last.closure[f]), 0.005) << t;
      lowest = std::min(lowest, now.X_WH.translation().z());
      highest = std::max(highest, now.X_WH.translation().z());
      last = now;
    }
    EXPECT_LT(fastest, 1.3) << "m/s, a calm reach";
    EXPECT_GT(lowest, 0.0) << "the back of the hand above the table";
    EXPECT_GT(highest - hand->grasp().translation().z(), 0.119) << "lifts 12 cm";
  }
}

TEST_F(EveryObject, IsAFunctionOfTheFrameNumberAndSeed) {
  const model::Scene scene = scene_with(known.objects().front());
  const auto a = SyntheticHand::create(scene, known, {.X_WT = X_WT});
  const auto b = SyntheticHand::create(scene, known, {.X_WT = X_WT});
  const auto c = SyntheticHand::create(scene, known, {.X_WT = X_WT, .seed = 1});
  ASSERT_TRUE(a && b && c);
  for (const std::uint64_t n : {200u, 3u, 77u}) {
    EXPECT_EQ(a->frame(n)->readings[1].p_TS, b->frame(n)->readings[1].p_TS);
    EXPECT_NE(a->frame(n)->readings[1].p_TS, c->frame(n)->readings[1].p_TS);
  }
}

TEST_F(EveryObject, ShowsTheNoiseThatTheSceneAsksFor) {
  model::Scene scene = scene_with(known.objects().front());
  scene.demonstrator.position_noise = 0;
  scene.demonstrator.angle_noise = 0;
  scene.demonstrator.extreme_rate = 0;
  const auto clean = SyntheticHand::create(scene, known, {.X_WT = X_WT, .rate = 1000});
  scene.demonstrator.position_noise = 0.0015;
  scene.demonstrator.extreme_rate = 0.01;
  const auto noisy = SyntheticHand::create(scene, known, {.X_WT = X_WT, .rate = 1000});
  ASSERT_TRUE(clean && noisy);
  int extreme = 0, count = 0;
  double squares = 0, farthest = 0;
  for (std::uint64_t n = 0; n < 5000; ++n)
    for (std::size_t s = 0; s < 4; ++s) {
      const double d =
          (clean->frame(n)->readings[s].p_TS - noisy->frame(n)->readings[s].p_TS).norm();
      farthest = std::max(farthest, d);
      if (d > 0.02) {
        ++extreme;
      } else {
        squares += d * d;
        ++count;
      }
    }
  EXPECT_NEAR(extreme / 20000.0, 0.01, 0.003);  // four sigma of a binomial
  EXPECT_NEAR(std::sqrt(squares / count / 3), 0.0015, 0.0001);
  EXPECT_LT(farthest, 0.51);
}

// The whole chain of the glove: with the noise and extreme points of the scene, the published hand
// follows the true one within a frame's motion (1 m/s at 30 Hz: 3 cm) and the sensor's mounting.
TEST_F(EveryObject, ComesOutOfTheProcessorWhereItWent) {
  for (const auto& object : known.objects()) {
    const auto hand = SyntheticHand::create(scene_with(object), known, {.X_WT = X_WT, .rate = 30});
    ASSERT_TRUE(hand);
    Processor processor({.X_WT = X_WT});
    int published = 0;
    for (std::uint64_t n = 0; n < 600; ++n) {
      const auto frame = hand->frame(n);
      const Processed out = processor.process(*frame, frame->stamp);
      if (!out.posture) continue;
      ++published;
      const Pose X_WH = hand->hand(static_cast<double>(n) / 30).X_WH;
      ASSERT_LT((out.posture->X_WH.translation() - X_WH.translation()).norm(), 0.045) << n;
      ASSERT_LT(angle_between(out.posture->X_WH.linear(), X_WH.linear()), 0.07);
    }
    EXPECT_GT(published, 580);
  }
}

TEST(SyntheticHand, RefusesWhatCannotBe) {
  const model::Catalogue known = catalogue();
  model::Scene scene = scene_with(known.objects().front());
  EXPECT_FALSE(SyntheticHand::create(scene, known, {.rate = 0}));
  EXPECT_FALSE(SyntheticHand::create(scene, known, {.rate = 1001}));
  EXPECT_FALSE(SyntheticHand::create(scene, known, {.rate = NAN}));
  scene.demonstrator.target = "Grand piano";
  EXPECT_FALSE(SyntheticHand::create(scene, known, {}));
  scene.demonstrator.target.clear();
  EXPECT_TRUE(SyntheticHand::create(scene, known, {})) << "poses only";
}

}  // namespace
}  // namespace prehend::glove
