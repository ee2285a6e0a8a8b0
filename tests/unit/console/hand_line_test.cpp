// What the page says of a hand, as the glove hears it.
#include "services/console/core/hand_line.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/base/pose.hpp"

namespace prehend::console {
namespace {

using nlohmann::json;

constexpr std::int64_t now = 1'700'000'000'500'000'000;

json hand(std::size_t points = 21) {
  json all = json::array();
  for (std::size_t i = 0; i < points; ++i)
    all.push_back({0.01 * static_cast<double>(i), -0.2, 0.3});
  return {{"hand", "right"}, {"origin", "room"}, {"age_s", 0.125}, {"points_m", all}};
}

TEST(HandLine, IsStampedByTheLabsClockAndInTheTrackersFrame) {
  // The tracker hangs 1 m above the table and looks down.
  const Pose X_WT = make_pose(Eigen::Vector3d(0, 0, 1), Eigen::Quaterniond(0, 1, 0, 0));
  const auto line = hand_line(hand().dump(), now, X_WT.inverse());
  ASSERT_TRUE(line) << line.error().message();
  const json said = json::parse(*line);
  EXPECT_EQ(said["version"], 1);
  EXPECT_NEAR(said["stamp_s"].get<double>(), 1'700'000'000.375, 1e-5);
  EXPECT_EQ(said["hand"], "right");
  EXPECT_EQ(said["points_m"].size(), 21U);
  const auto number = [&](std::size_t k) { return said["points_m"][4][k].get<double>(); };
  EXPECT_NEAR(number(0), 0.04, 1e-5);
  EXPECT_NEAR(number(1), 0.2, 1e-5);
  EXPECT_NEAR(number(2), 0.7, 1e-5);
}

TEST(HandLine, PointsThatAreOnlyRelativeStayAsTheyAre) {
  json body = hand(25);
  body["origin"] = "hand";
  body["hand"] = "left";
  const auto line = hand_line(body.dump(), now, make_pose(Eigen::Vector3d(1, 2, 3)));
  ASSERT_TRUE(line);
  EXPECT_EQ(json::parse(*line)["points_m"], body["points_m"]);
}

TEST(HandLine, WhatIsNoHandIsRefused) {
  const auto refused = [](const json& body) {
    return !hand_line(body.dump(), now, Pose::Identity());
  };
  EXPECT_FALSE(refused(hand()));
  for (const auto& [field, value] : std::map<std::string, json>{{"hand", "both"},
                                                                {"origin", "moon"},
                                                                {"age_s", 0.31},
                                                                {"age_s", -0.1},
                                                                {"age_s", "0"}}) {
    json body = hand();
    body[field] = value;
    EXPECT_TRUE(refused(body)) << body;
    body.erase(field);
    EXPECT_TRUE(refused(body)) << body;
  }
  EXPECT_TRUE(refused(hand(20)));
  EXPECT_TRUE(refused(json::array()));
  json far = hand();
  far["points_m"][3] = {0, 0, 5.1};
  EXPECT_TRUE(refused(far));
  far["points_m"][3] = {0, nullptr, 1};
  EXPECT_TRUE(refused(far));
  EXPECT_FALSE(hand_line("{", now, Pose::Identity()));
  EXPECT_FALSE(hand_line(R"({"hand":1e999})", now, Pose::Identity()));
}

}  // namespace
}  // namespace prehend::console
