// Takes of real people: an object is put where fingers of a recording close. On a made hand whose
// fingertips are known it must stand between them; on recordings, where nobody knows, the doubt is
// stated and bounded.
#include "services/mapping/tools/judging/real_reach.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "common/grasping/table_closing.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;

/// An average hand that closes all fingers, or thumb, index and middle finger, and opens again.
RealTake made_hand(bool pinch) {
  RealTake take{"made", 1, {}};
  for (int i = 0; i <= 60; ++i) {
    const double c = 0.5 - 0.5 * std::cos(std::numbers::pi * i / 30);
    const double others = pinch ? 0 : c;
    const auto tips =
        model::HumanHand(1).fingertip_poses(model::HumanHand::posture({c, c, c, others, others}));
    RealTake::Frame frame;
    frame.time = i / 30.;
    for (std::size_t f = 0; f < tips.size(); ++f)
      frame.fingertips[f] = {true, tips[f].translation()};
    take.frames.push_back(frame);
  }
  return take;
}

/// A standing cylinder that is taken from the side, or from above.
RobotGrasp grasp_of(GraspType type, double radius) {
  RobotGrasp grasp;
  grasp.object = "can";
  grasp.type = type;
  grasp.shape = {model::ShapeKind::cylinder, {radius, radius, 0.2}};
  const auto ways = grasping::approaches(grasp.shape, model::Reach{});
  grasp.X_OG = type == GraspType::power_wrap ? ways.back() : ways.front();
  return grasp;
}

TEST(RealReach, FindsWhenFingersClose) {
  const RealTake wrap = made_hand(false), pinch = made_hand(true);
  const auto closings = closings_of(wrap);
  ASSERT_EQ(closings.size(), 1u);
  EXPECT_LE(closings[0].open, 2u);
  EXPECT_NEAR(static_cast<double>(closings[0].closed), 30, 4);
  EXPECT_GT(closings[0].open_span, closings[0].closed_span + 0.04);
  EXPECT_FALSE(closings[0].pinch);
  ASSERT_EQ(closings_of(pinch).size(), 1u);
  EXPECT_TRUE(closings_of(pinch)[0].pinch);
  RealTake still = wrap;
  for (auto& frame : still.frames) frame.fingertips = wrap.frames[0].fingertips;
  EXPECT_TRUE(closings_of(still).empty());
}

TEST(RealReach, PutsTheObjectBetweenTheFingertips) {
  const RealTake pinch = made_hand(true);
  const RealClosing closing = closings_of(pinch).at(0);
  const RobotGrasp grasp = grasp_of(GraspType::precision, 0.02);
  const auto placed = place_object(closing, grasp);
  ASSERT_TRUE(placed);
  const RecordedTake take = real_reach(closing, grasp, *placed, {});
  // At the touch the middle of the tips is where the grasp frame was demonstrated, and the way from
  // thumb to fingers goes along its closing direction.
  const auto& tips = pinch.frames[placed->touch].fingertips;
  const Pose X_WH = take.X_WG * model::HumanHand(1).X_HG().inverse();
  const Vector3d thumb = X_WH * tips[0].p_HF;
  const Vector3d fingers = X_WH * Vector3d(0.5 * (tips[1].p_HF + tips[2].p_HF));
  const Pose X_WG_shown = take.X_WO * grasp.X_OG;
  EXPECT_LT((0.5 * (thumb + fingers) - X_WG_shown.translation()).norm(), 1e-9);
  EXPECT_LT((fingers - thumb).normalized().cross(X_WG_shown.linear().col(1)).norm(), 1e-6);
  // As wide as the object and two pads, but for what a frame moves.
  EXPECT_NEAR((fingers - thumb).norm(), 0.04 + 0.016, 0.01);
  EXPECT_LT(placed->off_surface, 0.03);
}

TEST(RealReach, PlaysTheRecordedFingersAfterTheReach) {
  const RealTake wrap = made_hand(false);
  const RealClosing closing = closings_of(wrap).at(0);
  const RobotGrasp grasp = grasp_of(GraspType::power_wrap, 0.02);
  const auto placed = place_object(closing, grasp);
  ASSERT_TRUE(placed);
  const RecordedTake take = real_reach(closing, grasp, *placed, {});
  EXPECT_EQ(take.postures.front().fingertips[1].p_HF, wrap.frames[closing.open].fingertips[1].p_HF);
  EXPECT_EQ(take.postures.back().fingertips[1].p_HF,
            wrap.frames[closing.closed].fingertips[1].p_HF);
  for (std::size_t k = 1; k < take.postures.size(); ++k)
    EXPECT_GT(take.postures[k].stamp, take.postures[k - 1].stamp);
  EXPECT_NE(take.user.find("real made at"), std::string::npos) << take.user;
  EXPECT_NE(take.user.find("off by"), std::string::npos) << take.user;
}

TEST(RealReach, RefusesObjectsThatDoNotFit) {
  const RealTake wrap = made_hand(false);
  const RealClosing closing = closings_of(wrap).at(0);
  RobotGrasp wide = grasp_of(GraspType::power_wrap, 0.02);
  wide.shape.size.head<2>().setConstant(0.2);
  EXPECT_FALSE(place_object(closing, wide));
  EXPECT_FALSE(place_object(closing, grasp_of(GraspType::precision, 0.02))) << "that is a pinch";
}

TEST(RealReach, StatesItsDoubtOfRecordings) {
  const auto folder = shared_data() / "leap_hand_recordings";
  std::vector<RealTake> people;
  for (const char* name : {"grab.csv", "pinch.csv"})
    if (auto take = load_real_take(folder / name)) people.push_back(std::move(*take));
  if (people.empty()) GTEST_SKIP() << "no " << folder;
  const auto takes = real_takes(
      people, {grasp_of(GraspType::power_wrap, 0.025), grasp_of(GraspType::precision, 0.015)}, 3, 7,
      {});
  ASSERT_FALSE(takes.empty());
  int number = 7;
  for (const BenchmarkTake& take : takes) {
    EXPECT_EQ(take.number, number++);
    EXPECT_TRUE(take.real);
    EXPECT_TRUE(take.recorded.user.starts_with("real ")) << take.recorded.user;
    for (const RealTake& person : people)
      for (const RealClosing& closing : closings_of(person))
        if (const auto placed = place_object(closing, take.grasp)) {
          EXPECT_LT(placed->off_surface, 0.1);
          EXPECT_LE(placed->off_axis, std::numbers::pi / 4 + 1e-9);
        }
  }
}

// 621 frames of another camera, which tells only points.
TEST(RealReach, ReadsLandmarksToo) {
  const auto file = shared_data() / "landmark_hand_recording" / "human_joint_right.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const auto take = load_real_take(file);
  ASSERT_TRUE(take) << take.error().message();
  EXPECT_GT(take->frames.size(), 600u);
  EXPECT_GT(take->hand_scale, 0.8);
  EXPECT_LT(take->hand_scale, 1.25);
  EXPECT_FALSE(closings_of(*take).empty());
}

}  // namespace
}  // namespace prehend::mapping
