// Which kind of human grasp a robot's grasp looks like: contacts made for the purpose, on the DLR
// hand, and what the planner finds.
#include "services/planner/tools/planning/grasp_class.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/planner/planning/plans.hpp"

namespace prehend::planner {
namespace {

const model::GraspTaxonomy& taxonomy() {
  static const auto made =
      model::GraspTaxonomy::load(test::in_sources("common/models/grasps/taxonomy.toml"));
  return *made;
}

const model::HandModel& dlr() {
  return test::hand("dlr");
}

const std::string& tip(std::size_t finger) {
  return dlr().links()[static_cast<std::size_t>(dlr().fingertips()[finger].link)].name;
}

/// On a circle about z, at these angles, pressing inwards.
std::vector<analysis::Contact> ring(double radius, const std::vector<double>& degrees) {
  std::vector<analysis::Contact> made;
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    const double a = degrees[i] * std::numbers::pi / 180;
    const Eigen::Vector3d out(std::cos(a), std::sin(a), 0);
    made.push_back({.link = tip(i), .p_OC = radius * out, .normal_O = -out});
  }
  return made;
}

std::string kind_of(const std::vector<analysis::Contact>& contacts, const Eigen::Vector3d& approach,
                    const std::optional<model::Shape>& shape) {
  const auto looks = looks_of(dlr(), contacts, approach, shape, taxonomy());
  return looks ? looks->name : looks.error().message();
}

const Eigen::Vector3d from_above(0, 0, -1), from_the_side(0, -1, 0);

model::Shape cylinder(double radius) {
  return {model::ShapeKind::cylinder, {radius, radius, 0.1}};
}

TEST(GraspClass, FingertipsAroundTheWayOfThePalmAreCircular) {
  EXPECT_EQ(kind_of(ring(0.04, {0, 90, 180, 270}), from_above, cylinder(0.04)), "precision disk");
  EXPECT_EQ(kind_of(ring(0.015, {0, 120, 240}), from_above, cylinder(0.015)), "tripod");
}

TEST(GraspClass, FingertipsFromTwoSidesArePrismaticAndCounted) {
  for (const auto& [angles, name] :
       {std::pair(std::vector<double>{0, 180}, "thumb-index finger"),
        std::pair(std::vector<double>{0, 178, 182}, "thumb-2 finger"),
        std::pair(std::vector<double>{0, 175, 180, 185}, "thumb-3 finger")})
    EXPECT_EQ(kind_of(ring(0.01, angles), from_above, cylinder(0.01)), name);
}

TEST(GraspClass, WhatAlsoLiesInThePalmIsPower) {
  auto wrap = ring(0.035, {30, 150, 180, 210});
  wrap.push_back({.link = dlr().links()[0].name,
                  .p_OC = Eigen::Vector3d(0, -0.035, 0),
                  .normal_O = Eigen::Vector3d(0, 1, 0)});
  EXPECT_EQ(kind_of(wrap, from_the_side, cylinder(0.035)), "large diameter");
  auto thin = ring(0.01, {0, 180});
  thin.push_back({.link = dlr().links()[0].name,
                  .p_OC = Eigen::Vector3d(0, -0.01, 0),
                  .normal_O = Eigen::Vector3d(0, 1, 0)});
  EXPECT_EQ(kind_of(thin, from_the_side, cylinder(0.01)), "small diameter");
}

TEST(GraspClass, WhatPressesFromOneSideIsAPlatform) {
  auto flat = ring(0.01, {90, 90, 90});
  EXPECT_EQ(kind_of(flat, from_above, std::nullopt), "platform");
}

TEST(GraspClass, RefusesWhatIsNoGraspOfTheHand) {
  EXPECT_FALSE(looks_of(dlr(), {}, from_above, {}, taxonomy()));
  auto foreign = ring(0.02, {0, 180});
  foreign[1].link = "tail";
  const auto looks = looks_of(dlr(), foreign, from_above, {}, taxonomy());
  ASSERT_FALSE(looks);
  EXPECT_NE(looks.error().what.find("tail"), std::string::npos);
  // A taxonomy of one kind alone: what presses from one side.
  const auto flat = model::GraspTaxonomy::parse(
      "[[class]]\nname = \"platform\"\nfeix = 22\nkind = \"power\"\nform = \"flat\"\n"
      "opposition = \"palm\"\nopposed = [\"index\"]\nthumb = \"free\"\napproach = "
      "\"above\"\nblocks = []\n"
      "shapes = [\"box\"]\nwidth = [0.1, 0.2]\nrobot = \"precision\"\n");
  ASSERT_TRUE(flat) << flat.error().message();
  const auto none = looks_of(dlr(), ring(0.01, {0, 180}), from_above, {}, *flat);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().what, "no class of the taxonomy is of this kind and form");
}

TEST(GraspClass, EveryPlannedGraspIsOfSomeKind) {
  const grasping::Plan& plan = barrett_on_talc();
  ASSERT_FALSE(plan.grasps.empty());
  for (const grasping::PlannedGrasp& grasp : plan.grasps) {
    const auto looks = looks_of(test::hand("barrett"), grasp.contacts,
                                (grasp.X_OB * test::hand("barrett").X_BG()).linear().col(2),
                                talc.shape, taxonomy());
    ASSERT_TRUE(looks) << looks.error().message();
    EXPECT_NE(taxonomy().find(looks->name), nullptr);
    EXPECT_NE(looks->form, model::GraspForm::flat) << "it resists every wrench";
  }
}

}  // namespace
}  // namespace prehend::planner
