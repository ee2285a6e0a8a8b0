// Which servo moves what: dynamixel.toml.
#include "services/robot/core/dynamixel_wiring.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "common/base/file_text.hpp"

namespace prehend::robot::dynamixel {
namespace {

const model::HandModel& jaw() {
  static const auto loaded = model::HandModel::load(model::hand_directory("parallel_jaw"));
  return *loaded;
}

std::string why_not(const std::string& toml) {
  const auto wiring = parse_wiring(toml, jaw(), "w.toml");
  return wiring ? "" : wiring.error().message();
}

const std::string header = "[servos]\ntorque_per_ampere = 0.5\nmax_current = 700\n";

TEST(DynamixelWiring, SaysWhereADoFIsAndWhatItsEffortTakes) {
  const auto wiring = parse_wiring(
      header + "current_unit = 2\n[[servo]]\nid = 9\ndof = \"jaw\"\nzero = 2048\nratio = -100\n",
      jaw(), "w.toml");
  ASSERT_TRUE(wiring) << wiring.error().message();
  const Servo& servo = wiring->front();
  EXPECT_EQ(servo.id, 9);
  EXPECT_NEAR(servo.position_of(0.01), 2048 - 4096 / (2 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(servo.dof_at(servo.position_of(0.03)), 0.03, 1e-12);
  EXPECT_NEAR(servo.current, 10, 1e-9);  // 1 N is 10 mN m, which take 20 mA
  EXPECT_EQ(servo.max_current, 350);
}

TEST(DynamixelWiring, TheJawsOwnIsRight) {
  const auto text = read_file(model::hand_directory("parallel_jaw") / "dynamixel.toml");
  ASSERT_TRUE(text);
  const auto wiring = parse_wiring(*text, jaw(), "dynamixel.toml");
  ASSERT_TRUE(wiring) << wiring.error().message();
  EXPECT_EQ(wiring->size(), 1u);
}

TEST(DynamixelWiring, WhatIsWrongIsSaid) {
  const std::string good = "[[servo]]\nid = 1\ndof = \"jaw\"\nzero = 0\n";
  EXPECT_EQ(why_not(header + good), "");
  EXPECT_NE(why_not(good).find("servos.torque_per_ampere"), std::string::npos);
  EXPECT_NE(why_not(header).find("servo"), std::string::npos);
  EXPECT_NE(why_not(header + good + good).find("two servos"), std::string::npos);
  EXPECT_NE(why_not(header + good + "speed = 1\n").find("unknown key"), std::string::npos);
  EXPECT_NE(why_not(header + good + "ratio = 0\n").find("must not be 0"), std::string::npos);
  EXPECT_NE(why_not(header + good + "ratio = nan\n"), "");
  EXPECT_NE(why_not(header + good + "ratio = 1e9\n").find("too often"), std::string::npos);
  EXPECT_NE(why_not(header + "[[servo]]\nid = 253\ndof = \"jaw\"\nzero = 0\n").find("0 to 252"),
            std::string::npos);
  EXPECT_NE(why_not(header + "[[servo]]\nid = 1\ndof = \"thumb\"\nzero = 0\n").find("no such DoF"),
            std::string::npos);
  EXPECT_NE(why_not(header + "[[servo]]\nid = 1\ndof = \"jaw\"\n").find("zero"), std::string::npos);
  EXPECT_NE(why_not("["), "");
  // A hand with more of them.
  const auto barrett = model::HandModel::load(model::hand_directory("barrett"));
  ASSERT_TRUE(barrett);
  const auto missing =
      parse_wiring(header + "[[servo]]\nid = 1\ndof = \"spread\"\nzero = 0\n", *barrett, "w.toml");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message().find("not every DoF"), std::string::npos);
}

}  // namespace
}  // namespace prehend::robot::dynamixel
