// The world behind the topics: what it refuses, how it follows the clock, when it holds still, and
// a whole grasp: commands reach, close and lift; one closure is found and judged.
#include "services/simulation/core/simulation.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/model/hand_model.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;
using namespace prehend::simulation;
using Eigen::Vector3d;
using Eigen::VectorXd;
using std::chrono::milliseconds;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
const Time start = from_ns(1'700'000'000'000'000'000);

const model::HandModel& barrett() {
  return test::hand("barrett");
}

const grasping::Body talc{
    "Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};

std::unique_ptr<Simulation> made(const Options& options = {}) {
  auto simulation = Simulation::create(barrett(), options);
  if (!simulation) throw std::runtime_error(simulation.error().message());
  (*simulation)->follow(start, false);
  return std::move(*simulation);
}

/// The hand beside an object at the origin, G at p, palm along y, its x axis up.
Command command(const Vector3d& p_WG, double closure) {
  const Eigen::Matrix3d R = model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  Command made;
  made.model = "barrett";
  made.X_WB = make_pose(p_WG, R) * barrett().X_BG().inverse();
  made.dof = VectorXd::Constant(4, closure);
  made.dof[0] = 0;
  return made;
}

void run_until(Simulation& simulation, Time time) {
  simulation.follow(time, true);
  while (simulation.step()) {
  }
}

TEST(Simulation, RefusesCommandsThatCannotBeFollowed) {
  const auto simulation = made();
  Command other = command({0, 0, 0.3}, 0);
  other.model = "robonaut";
  EXPECT_EQ(simulation->accept(other, start).error().what, "command for another model");
  Command shorter = command({0, 0, 0.3}, 0);
  shorter.dof = VectorXd::Zero(3);
  EXPECT_EQ(simulation->accept(shorter, start).error().what, "command of wrong length");
  Command broken = command({0, 0, 0.3}, 0);
  broken.dof[2] = nan;
  EXPECT_EQ(simulation->accept(broken, start).error().what, "command not finite");
  broken = command({0, 0, 0.3}, 0);
  broken.X_WB.translation().x() = nan;
  EXPECT_EQ(simulation->accept(broken, start).error().what, "command not finite");
  broken = command({0, 0, 0.3}, 0);
  broken.effort = VectorXd::Ones(3);
  EXPECT_FALSE(simulation->accept(broken, start));
  EXPECT_FALSE(simulation->accept(command({0, 0, 300}, 0), start));
  const auto beyond = simulation->accept(command({0, 0, 0.3}, -1), start);
  EXPECT_EQ(beyond.error().what, "command outside limits");
  const Pose before = simulation->world().hand_motion().X_WB;
  run_until(*simulation, start + milliseconds(100));
  EXPECT_LT((simulation->world().hand_motion().X_WB.translation() - before.translation()).norm(),
            1e-9);
}

TEST(Simulation, FollowsTheClockExactlyInLockstepAndCatchesUpALittleLive) {
  const auto simulation = made();
  int steps = 0;
  EXPECT_EQ(simulation->follow(start + milliseconds(1000), true), Duration::zero());
  while (simulation->step()) ++steps;
  EXPECT_EQ(steps, 500);
  EXPECT_EQ(simulation->time(), start + milliseconds(1000));
  EXPECT_EQ(simulation->follow(start + milliseconds(1300), false), milliseconds(250));
  for (steps = 0; simulation->step();) ++steps;
  EXPECT_EQ(steps, 25);
  EXPECT_EQ(simulation->time(), start + milliseconds(1300));
  EXPECT_EQ(simulation->follow(start + milliseconds(1200), false), Duration::zero());
  EXPECT_FALSE(simulation->step());  // a clock that goes back moves nothing
}

TEST(Simulation, TheFirstCommandPlacesTheHandLaterOnesMoveIt) {
  const auto simulation = made();
  const Command first = command({0.3, 0, 0.3}, 0), second = command({0.6, 0, 0.3}, 0);
  ASSERT_TRUE(simulation->accept(first, start));
  const auto at = [&]() -> Vector3d {
    return simulation->world().hand_motion().X_WB.translation();
  };
  EXPECT_LT((at() - first.X_WB.translation()).norm(), 1e-9);
  ASSERT_TRUE(simulation->accept(second, start));
  run_until(*simulation, start + milliseconds(100));
  EXPECT_LT((at() - first.X_WB.translation()).norm(), 0.1);
}

// An effort of nothing at all moves no finger; the next command may use all there is again.
TEST(Simulation, FingersUseNoMoreEffortThanTheCommandAllows) {
  const auto simulation = made();
  ASSERT_TRUE(simulation->accept(command({0, 0, 0.5}, 0), start));
  Command weak = command({0, 0, 0.5}, 1);
  weak.effort = VectorXd::Zero(4);
  ASSERT_TRUE(simulation->accept(weak, start));
  run_until(*simulation, start + milliseconds(150));
  EXPECT_LT(simulation->world().hand_motion().dof.cwiseAbs().maxCoeff(), 1e-3);
  ASSERT_TRUE(simulation->accept(command({0, 0, 0.5}, 1), start + milliseconds(150)));
  run_until(*simulation, start + milliseconds(300));
  EXPECT_GT(simulation->world().hand_motion().dof[1], 0.05);
}

TEST(Simulation, TheFirstCommandNeverPlacesTheHandIntoAnObject) {
  const auto simulation = made();
  const Command into = command({0, 0, 0.06}, 0);
  ASSERT_TRUE(simulation->see(talc, into.X_WB));
  const Vector3d before = simulation->world().hand_motion().X_WB.translation();
  ASSERT_TRUE(simulation->accept(into, start));
  EXPECT_LT((simulation->world().hand_motion().X_WB.translation() - before).norm(), 1e-9);
}

TEST(Simulation, HoldsStillWhenCommandsStop) {
  const auto simulation = made();
  ASSERT_TRUE(simulation->accept(command({0, 0, 0.5}, 0), start));
  ASSERT_TRUE(simulation->accept(command({0, 0, 1.5}, 0), start));
  run_until(*simulation, start + milliseconds(199));
  EXPECT_FALSE(simulation->is_holding_still());
  run_until(*simulation, start + milliseconds(204));
  EXPECT_TRUE(simulation->is_holding_still());
  const Vector3d then = simulation->world().hand_motion().X_WB.translation();
  run_until(*simulation, start + milliseconds(2000));
  // It was told to stay where it was up to two steps before, at up to 1 m/s.
  EXPECT_LT((simulation->world().hand_motion().X_WB.translation() - then).norm(), 5e-3);
  ASSERT_TRUE(simulation->accept(command({0, 0, 1.5}, 0), start + milliseconds(2000)));
  EXPECT_FALSE(simulation->is_holding_still());
}

// A stop: the arm brakes with 20 m/s², twice as hard as on its way, so from 1 m/s it needs 50 ms
// and 2.5 cm, and does not come back.
TEST(Simulation, StopsWithoutComingBack) {
  const auto simulation = made();
  ASSERT_TRUE(simulation->accept(command({0, 0, 0.5}, 0), start));
  ASSERT_TRUE(simulation->accept(command({0, 0, 2.5}, 0), start));
  const auto height = [&] { return simulation->world().hand_motion().X_WB.translation().z(); };
  run_until(*simulation, start + milliseconds(190));
  const double at_stop = height();
  simulation->hold();
  double before = at_stop;
  for (int ms = 192; ms < 1000; ms += 2) {
    run_until(*simulation, start + milliseconds(ms));
    EXPECT_GE(height(), before - 1e-5) << ms;
    if (ms > 250) {
      EXPECT_LT(height() - before, 1e-6) << ms;
    }
    before = height();
  }
  EXPECT_GT(before, at_stop + 0.015);
  EXPECT_LT(before, at_stop + 0.03);
  EXPECT_TRUE(simulation->is_holding_still());
  EXPECT_FALSE(simulation->is_braking());
  // Then it goes on no harder than before: with 10 m/s² it has 0.22 m/s after 22 ms.
  ASSERT_TRUE(simulation->accept(command({0, 0, 2.5}, 0), start + milliseconds(1000)));
  run_until(*simulation, start + milliseconds(1020));
  EXPECT_LT(height() - before, 0.22 * 0.022);
}

TEST(Simulation, SightingsPlaceObjectsAndMoveThemOnlyWhileTheHandIsFar) {
  const auto simulation = made();
  const auto place = [&]() -> Vector3d {
    return simulation->world().body_motion(0).X_WO.translation();
  };
  EXPECT_TRUE(*simulation->see(talc, make_pose(Vector3d(0.1, 0, 0.07))));
  EXPECT_LT((place() - Vector3d(0.1, 0, 0.0525)).norm(), 1e-12);  // stands on the table
  EXPECT_FALSE(*simulation->see(talc, make_pose(Vector3d(0.2, 0, 0.05))));
  EXPECT_LT((place() - Vector3d(0.2, 0, 0.0525)).norm(), 1e-12);
  EXPECT_EQ(simulation->world().body_count(), 1);

  ASSERT_TRUE(simulation->accept(command({0.2, -0.04, 0.06}, 0), start));
  EXPECT_FALSE(*simulation->see(talc, make_pose(Vector3d(0.1, 0, 0.05))));
  EXPECT_LT((place() - Vector3d(0.2, 0, 0.0525)).norm(), 1e-12);

  grasping::Body bad = talc;
  bad.name = "bad";
  bad.shape.size.x() = nan;
  EXPECT_FALSE(simulation->see(bad, Pose::Identity()));
  bad = talc;
  bad.name = "lost";
  EXPECT_FALSE(simulation->see(bad, make_pose(Vector3d(nan, 0, 0))));
  EXPECT_EQ(simulation->world().body_count(), 1);
}

TEST(Simulation, ATableHasRoomForSoManyObjects) {
  const auto simulation = made();
  grasping::Body cup = talc;
  for (int i = 0; i < 32; ++i) {
    cup.name = "cup " + std::to_string(i);
    ASSERT_TRUE(simulation->see(cup, make_pose(Vector3d(0.2 * i, 0, 0)))) << i;
  }
  EXPECT_EQ(simulation->see(talc, make_pose(Vector3d(0, 1, 0))).error().message(),
            "Talc: too many objects");
}

TEST(Simulation, AnOrderPlacesAnObjectWhereNothingIs) {
  const auto simulation = made();
  const auto stands_at = [&](int body) -> Vector3d {
    return simulation->world().body_motion(body).X_WO.translation();
  };
  grasping::Body cup = talc;
  cup.name = "cup";
  EXPECT_TRUE(*simulation->see(cup, make_pose(Vector3d(0, 0, 0))));
  EXPECT_TRUE(*simulation->place(talc, make_pose(Vector3d(0.2, 0, 0.9))));
  EXPECT_LT((stands_at(1) - Vector3d(0.2, 0, 0.0525)).norm(), 1e-12) << "it stands on the table";
  EXPECT_FALSE(*simulation->place(talc, make_pose(Vector3d(0.3, 0.1, 0)))) << "no new body";
  EXPECT_LT((stands_at(1) - Vector3d(0.3, 0.1, 0.0525)).norm(), 1e-12);
  // What is still seen of it where it was does not take it back.
  EXPECT_FALSE(*simulation->see(talc, make_pose(Vector3d(0.1, 0, 0))));
  EXPECT_LT((stands_at(1) - Vector3d(0.3, 0.1, 0.0525)).norm(), 1e-12);

  EXPECT_FALSE(simulation->place(talc, make_pose(Vector3d(0.03, 0.03, 0)))) << "the cup is there";
  EXPECT_TRUE(simulation->place(talc, make_pose(Vector3d(0.31, 0.1, 0))))
      << "it may stand on itself";
  ASSERT_TRUE(simulation->accept(command({-0.3, 0, 0.06}, 0), start));
  EXPECT_FALSE(simulation->place(talc, make_pose(Vector3d(-0.3, 0, 0)))) << "the hand is there";
  EXPECT_FALSE(simulation->place(talc, make_pose(Vector3d(nan, 0, 0))));
  EXPECT_FALSE(simulation->place(talc, make_pose(Vector3d(99, 0, 0))));
  EXPECT_LT((stands_at(1) - Vector3d(0.31, 0.1, 0.0525)).norm(), 1e-12);
}

struct Episode {
  std::vector<Closure> closures;
  std::unique_ptr<Simulation> simulation;
};

/// Commands at 30 Hz: reach from 25 cm away, close, wait, lift; `offset` is the error of the reach.
/// `tremble`: the second finger does not close but trembles by so much, rad. `shake`: the palm
/// trembles to either side by so much, m.
Episode reach_and_lift(const grasping::Body& body, const Vector3d& offset, double tremble = 0,
                       double shake = 0) {
  Episode episode{{}, made()};
  Simulation& simulation = *episode.simulation;
  if (!simulation.see(body, Pose::Identity())) throw std::runtime_error("not placed");
  for (int i = 0; i < 150; ++i) {
    const double t = i / 30.0;
    const double reach = std::min(1.0, t / 1.2), close = std::clamp((t - 1.4) / 0.8, 0.0, 1.0);
    const double lift = 0.12 * std::clamp((t - 3.2) / 0.8, 0.0, 1.0);
    const Time now = start + milliseconds(static_cast<long>(1000 * t));
    const Vector3d p =
        Vector3d(i % 2 == 0 ? shake : -shake, -0.25 * (1 - reach), 0.06 + lift) + offset;
    Command told = command(p, 1.4 * close);
    if (tremble > 0) told.dof[2] = 0.3 + tremble * std::sin(2 * EIGEN_PI * 3 * t);
    if (!simulation.accept(told, now)) throw std::runtime_error("refused");
    simulation.follow(now + milliseconds(33), true);
    while (simulation.step())
      if (auto closure = simulation.take_closure()) episode.closures.push_back(std::move(*closure));
  }
  return episode;
}

TEST(Simulation, AGraspIsFoundOnceJudgedAndReallyLifted) {
  Episode episode = reach_and_lift(talc, {0.005, 0.005, 0.005});
  ASSERT_EQ(episode.closures.size(), 1u);
  Closure& closure = episode.closures.front();
  EXPECT_EQ(closure.object.name, "Talc");
  EXPECT_GE(closure.contacts.size(), 3u);
  const GraspVerdict verdict = judge(closure);
  EXPECT_TRUE(verdict.hold.held) << verdict.hold.reason;
  EXPECT_TRUE(verdict.quality.force_closure);
  EXPECT_GT(verdict.quality.epsilon, 0.01);
  EXPECT_GT(verdict.quality.volume, 0);
  EXPECT_LT(verdict.penetration, 0.001);
  // The world itself went on and lifted it, too.
  EXPECT_NEAR(episode.simulation->world().body_motion(0).X_WO.translation().z(), 0.0525 + 0.12,
              0.02);
  EXPECT_FALSE(episode.simulation->world().touches_others(0));
}

TEST(Simulation, WhatTheHandHoldsIsNotTakenAwayByAnOrder) {
  Episode episode = reach_and_lift(talc, {0.005, 0.005, 0.005});
  EXPECT_FALSE(episode.simulation->place(talc, make_pose(Vector3d(0.5, 0.5, 0))));
}

// DLR's hand held what stood there, and no grasp was reported: a finger that touched nothing
// trembled with the operator's.
TEST(Simulation, AFingerThatTouchesNothingMayTremble) {
  EXPECT_EQ(reach_and_lift(talc, {0.005, 0.005, 0.005}, 0.04).closures.size(), 1u);
  EXPECT_TRUE(reach_and_lift(talc, {0, -0.10, 0}, 0.04).closures.empty());
}

// Hands of weak motors held what stood there, and no grasp was reported within 45 s: the operator's
// hand trembles, and with it all fingers that press.
TEST(Simulation, FingersThatPressMayTremble) {
  EXPECT_EQ(reach_and_lift(talc, {0.005, 0.005, 0.005}, 0, 0.002).closures.size(), 1u);
  EXPECT_TRUE(reach_and_lift(talc, {0, -0.10, 0}, 0, 0.002).closures.empty());
}

// Whether a hand has one drive or twelve, and whether its fingers stand at their ends or not.
TEST(Simulation, OneDriveThatPressesIsEnough) {
  const model::HandModel& jaw = test::hand("parallel_jaw");
  auto simulation = std::move(*Simulation::create(jaw, {}));
  simulation->follow(start, false);
  ASSERT_TRUE(simulation->see(talc, Pose::Identity()));
  Command told = command({0, 0, 0.06}, 0);
  told.model = "parallel_jaw";
  const Pose X_WG = told.X_WB * barrett().X_BG();
  int closures = 0;
  for (int i = 0; i < 90; ++i) {
    const double t = i / 30.0;
    const double reach = std::min(1.0, t / 0.8), close = std::clamp((t - 1.0) / 0.5, 0.0, 1.0);
    Pose X_WB = X_WG * jaw.X_BG().inverse();
    X_WB.pretranslate(Vector3d(0, -0.25 * (1 - reach), 0));
    told.X_WB = X_WB;
    told.dof = (1 - close) * jaw.postures().at("open");
    const Time now = start + milliseconds(static_cast<long>(1000 * t));
    ASSERT_TRUE(simulation->accept(told, now));
    simulation->follow(now + milliseconds(33), true);
    while (simulation->step()) closures += simulation->take_closure().has_value();
  }
  EXPECT_EQ(closures, 1);
}

TEST(Simulation, IsDeterministic) {
  const Episode a = reach_and_lift(talc, {0.003, 0, 0}), b = reach_and_lift(talc, {0.003, 0, 0});
  EXPECT_EQ(a.simulation->world().hand_motion().joint, b.simulation->world().hand_motion().joint);
  EXPECT_TRUE((a.simulation->world().body_motion(0).X_WO.matrix().array() ==
               b.simulation->world().body_motion(0).X_WO.matrix().array())
                  .all());
}

TEST(Simulation, ASlipperyObjectIsDroppedAndAMissedOneIsNoClosure) {
  grasping::Body slippery = talc;
  slippery.friction = 0.05;
  Episode dropped = reach_and_lift(slippery, Vector3d::Zero());
  for (Closure& closure : dropped.closures) EXPECT_FALSE(judge(closure).hold.held);
  EXPECT_LT(dropped.simulation->world().body_motion(0).X_WO.translation().z(), 0.1);
  const Episode missed = reach_and_lift(talc, {0, -0.10, 0});
  EXPECT_TRUE(missed.closures.empty());
}

/// All of the catalogue, 40 cm apart along x.
class OfAScene : public testing::Test {
 protected:
  OfAScene() {
    for (const auto& object : catalogue_->objects())
      scene_.objects.push_back(
          {object.name, make_pose(Vector3d(0.4 * static_cast<double>(scene_.objects.size()), 0,
                                           model::half_extents(object.shape).z()))});
  }
  Expected<model::Catalogue> catalogue_ =
      model::Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  Expected<grasping::CatalogueBodies> bodies_ = grasping::CatalogueBodies::create(*catalogue_);
  std::unique_ptr<Simulation> simulation_ = made();
  model::Scene scene_;
};

TEST_F(OfAScene, EverythingStandsThereOrIsSaidToBeMissing) {
  ASSERT_TRUE(simulation_->build(scene_, *bodies_));
  EXPECT_EQ(simulation_->world().body_count(), static_cast<int>(catalogue_->objects().size()));
  scene_.objects = {{"Teapot", Pose::Identity()}};
  EXPECT_FALSE(simulation_->build(scene_, *bodies_));
}

// Otherwise it lies there for ever, while the drawn camera, which is told the scene, shows it where
// it stood, and no later reach finds it.
TEST_F(OfAScene, WhatWasKnockedOverStandsAgainOnceTheHandIsFar) {
  ASSERT_TRUE(simulation_->build(scene_, *bodies_));
  const Pose stood = simulation_->world().body_motion(0).X_WO;
  const auto displaced = [&] {
    const Pose now = simulation_->world().body_motion(0).X_WO;
    return (now.translation() - stood.translation()).norm() +
           angle_between(now.linear(), stood.linear());
  };
  double furthest = 0;
  for (int i = 0; i < 90; ++i) {
    const double t = i / 30.0;
    const Time now = start + milliseconds(static_cast<long>(1000 * t));
    ASSERT_TRUE(simulation_->accept(command({0, -0.3 + 0.25 * t, 0.06}, 1.0), now));
    simulation_->follow(now + milliseconds(33), true);
    while (simulation_->step()) EXPECT_FALSE(simulation_->take_closure());
    furthest = std::max(furthest, displaced());
  }
  EXPECT_GT(furthest, 0.05);
  for (int i = 0; i < 30; ++i) {
    const Time now = start + milliseconds(3000 + 33 * i);
    ASSERT_TRUE(simulation_->accept(command({0, -0.4, 0.4}, 1.0), now));
    run_until(*simulation_, now + milliseconds(33));
  }
  EXPECT_LT(displaced(), 0.001);
}

}  // namespace
