// Two hands that press what is too wide for one have closed on it, though no finger presses; the
// contacts of both are judged.
#include <gtest/gtest.h>

#include <set>

#include "services/simulation/core/simulation.hpp"
#include "tests/support/hands.hpp"

namespace prehend::simulation {
namespace {

using Eigen::Vector3d;

const grasping::Body chest{"Chest", {model::ShapeKind::box, {0.30, 0.40, 0.40}}, 1.0, "wood", {}};
constexpr double beside = 0.23, inside = 0.17;  // m, of a base from the middle: free, and pressing
const Time start = from_ns(1'700'000'000'000'000'000);

/// The base at x that looks towards the chest, the fingers open and upright.
Command facing(double x) {
  const model::HandModel& barrett = test::hand("barrett");
  const double side = x < 0 ? 1 : -1;
  Eigen::Matrix3d R_WB;
  R_WB << Vector3d::UnitY() * side, Vector3d::UnitZ(), Vector3d::UnitX() * side;
  Command command;
  command.model = "barrett";
  command.X_WB = make_pose(Vector3d(x, 0, 0.2), R_WB);
  command.dof = barrett.postures().at("open");
  return command;
}

class Pressed : public testing::Test {
 protected:
  void SetUp() override {
    const model::HandModel& barrett = test::hand("barrett");
    simulation_ = std::move(*Simulation::create(barrett, {.push = push_of_several}));
    simulation_->follow(start, true);
    ASSERT_TRUE(simulation_->see(chest, Pose::Identity()));
    ASSERT_EQ(simulation_->add_hand(barrett).value(), 1);
    lead(beside, beside);
  }
  /// Each base goes so far from the middle within half a second, and stays there for one and a
  /// half.
  void lead(double left, double right) {
    for (int i = 0; i < 60; ++i) {
      const double share = std::min(1.0, i / 15.0);
      now_ += std::chrono::milliseconds(33);
      for (const int hand : {0, 1}) {
        double& at = at_[hand];
        const double x = at + share * ((hand == 0 ? -left : right) - at);
        ASSERT_TRUE(simulation_->accept(facing(x), now_, hand));
        if (i == 59) at = x;
      }
      simulation_->follow(now_, true);
      while (simulation_->step())
        while (auto closure = simulation_->take_closure()) closures_.push_back(std::move(*closure));
    }
  }
  std::set<int> hands() const {
    std::set<int> hands;
    for (const Closure& closure : closures_) hands.insert(closure.hand);
    return hands;
  }

  std::unique_ptr<Simulation> simulation_;
  std::vector<Closure> closures_;

 private:
  Time now_ = start;
  double at_[2] = {-beside, beside};  // m
};

TEST_F(Pressed, BetweenTwoHandsIsAClosureOfEach) {
  EXPECT_TRUE(closures_.empty());
  lead(inside, inside);
  EXPECT_EQ(closures_.size(), 2u);
  EXPECT_EQ(hands(), (std::set{0, 1}));
  for (Closure& closure : closures_) {
    EXPECT_EQ(closure.object.name, "Chest");
    std::set<int> touching;
    for (const analysis::Contact& contact : closure.contacts) touching.insert(contact.hand);
    EXPECT_EQ(touching, (std::set{0, 1}));
    const GraspVerdict verdict = judge(closure);
    EXPECT_TRUE(verdict.hold.held) << verdict.hold.reason;
    EXPECT_TRUE(verdict.quality.force_closure);
  }
  lead(beside, beside);
  EXPECT_EQ(closures_.size(), 2u);
  lead(inside, inside);
  EXPECT_EQ(closures_.size(), 4u) << "pressed once more";
}

TEST_F(Pressed, ByOneHandAloneIsNone) {
  lead(inside, beside);
  EXPECT_TRUE(closures_.empty());
}

TEST_F(Pressed, ByHandsThatComeAndGoIsNone) {
  lead(beside + 0.1, beside + 0.1);
  lead(beside, beside);
  EXPECT_TRUE(closures_.empty());
}

}  // namespace
}  // namespace prehend::simulation
