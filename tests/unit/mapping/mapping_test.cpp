// The mapping as a whole, with networks of random weights: its promises hold whatever they answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "common/model/placement.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using model::ShapeKind;
using std::chrono::milliseconds;

const model::Shape talc{ShapeKind::cylinder, {0.024, 0.024, 0.105}};
const Time start_time = Time(std::chrono::seconds(1'700'000'000));

Time at(int ms) {
  return start_time + milliseconds(ms);
}

/// A hand whose grasp frame is at X_WG.
Posture posture(const Pose& X_WG, int ms, double closure = 0) {
  const Pose X_WH = X_WG * model::HumanHand(1.0).X_HG().inverse();
  return {at(ms), at(ms - 3), X_WH, 1.0, tips({closure, closure, closure, closure, closure})};
}

RobotState state_at(const Pose& X_WB, const Eigen::VectorXd& dof, int ms) {
  const auto joints = static_cast<Eigen::Index>(barrett().joints().size());
  return {at(ms), dof, Eigen::VectorXd::Zero(joints), Eigen::VectorXd::Zero(joints), X_WB};
}

Detection detection(const model::Shape& shape, const Pose& X_WO, int ms, std::uint32_t track = 1) {
  return {track, "object " + std::to_string(track), shape, X_WO, 0.95, at(ms)};
}

Pose standing(const model::Shape& shape, double x = 0, double y = 0) {
  return make_pose(Eigen::Vector3d(x, y, half_extents(shape).z()));
}

/// Where a hand holds the object from the side.
Pose side_grasp(const model::Shape& shape, const Pose& X_WO) {
  Eigen::Matrix3d R;
  R << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // approach along x, fingers close along y
  return X_WO *
         *model::nearest_grasp(shape, make_pose(Eigen::Vector3d::Zero(), R), barrett().reach());
}

Pose base_at(const Pose& X_WG) {
  return X_WG * barrett().X_BG().inverse();
}

class MappingTest : public testing::Test {
 protected:
  MappingModel model_ = random_model(21);
  Mapping mapping_ = *Mapping::create(barrett(), model_, {});
  Eigen::VectorXd open_ = barrett().postures().at("open");
};

TEST_F(MappingTest, StartsWhereTheRobotIs) {
  const Eigen::Vector4d dof(0.1, 0.9, 0.7, 1.1);
  const Pose X_WB = make_pose(Eigen::Vector3d(0.3, -0.2, 0.5));
  ASSERT_TRUE(mapping_.on_state(state_at(X_WB, dof, 0)));
  const auto first = mapping_.on_posture(posture(Pose::Identity(), 1), at(2));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->dof, dof);
  EXPECT_TRUE(first->X_WB.isApprox(X_WB));
}

TEST_F(MappingTest, WaitsForTheRobotsStateAndThenStartsWithout) {
  const Pose X_WG = make_pose(Eigen::Vector3d(0, 0, 0.3));
  for (int ms = 0; ms < 1000; ms += 33) {
    const auto answer = mapping_.on_posture(posture(X_WG, ms), at(ms));
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().what, "no robot state yet");
    EXPECT_FALSE(mapping_.tick(at(ms + 20)));
  }
  const auto answer = mapping_.on_posture(posture(X_WG, 1000), at(1000));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->dof, open_);
  EXPECT_TRUE(answer->X_WB.isApprox(base_at(X_WG)));
}

TEST_F(MappingTest, FollowsTheHandPalmToPalmAndAnswersDirectly) {
  const Pose X_WG =
      make_pose(Eigen::Vector3d(0.2, 0.1, 0.3),
                Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix());
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(X_WG), open_, 0)));
  Expected<Command> last = fail("");
  for (int ms = 0; ms < 3000; ms += 33)
    last = mapping_.on_posture(posture(X_WG, ms, 0.4), at(ms + 2));
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->X_WB.isApprox(base_at(X_WG), 1e-9));  // products of a few rotations
  EXPECT_EQ(last->mode, Mode::direct);
  EXPECT_EQ(last->weight, 0);
  EXPECT_TRUE(last->object.empty());
  const Features f = *features(tips({0.4, 0.4, 0.4, 0.4, 0.4}), 1);
  EXPECT_TRUE(last->dof.isApprox(barrett().clamp(model_.direct(f).dof), 1e-9));
}

TEST_F(MappingTest, KnowsTheObjectInReachAndCorrectsThePlacement) {
  const Pose X_WO = standing(talc);
  const Pose grasp = side_grasp(talc, X_WO);
  // 2 cm and 8 degrees off: all of that can be corrected.
  const Pose X_WG =
      grasp * make_pose(Eigen::Vector3d(0, 0.02, 0),
                        Eigen::AngleAxisd(0.14, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(X_WG), open_, 0)));
  double weight = 0;
  Expected<Command> last = fail("");
  for (int ms = 0; ms < 3000; ms += 33) {
    ASSERT_TRUE(mapping_.on_detection(detection(talc, X_WO, ms)));
    last = mapping_.on_posture(posture(X_WG, ms, 0.4), at(ms + 2));
    ASSERT_TRUE(last);
    EXPECT_GE(last->weight, weight);
    weight = last->weight;
  }
  EXPECT_EQ(weight, 1);
  EXPECT_EQ(last->mode, Mode::intelligent);
  EXPECT_EQ(last->object, "object 1");
  const Pose expected =
      X_WO * *model::nearest_grasp(talc, X_WO.inverse() * X_WG, barrett().reach());
  const Pose X_GG = expected.inverse() * last->X_WB * barrett().X_BG();
  EXPECT_LT(X_GG.translation().cwiseProduct(Eigen::Vector3d(1, 0, 1)).norm(), 1e-6);
  EXPECT_LT(std::abs(X_GG.translation().y()), 0.03) << "the hand may yield along y";
  EXPECT_LT(angle_between(X_GG.linear(), Eigen::Matrix3d::Identity()), 1e-6);
  const Features f = *features(tips({0.4, 0.4, 0.4, 0.4, 0.4}), 1);
  EXPECT_TRUE(last->dof.isApprox(
      barrett().clamp(model_.intelligent(f, talc, Pose::Identity())->dof), 1e-9));
}

// Whatever the networks answer: some reach into the object, and those fingers go on, though the
// others may have been answered short of it; none does that stays clear of it.
TEST(MappingOfKnownObject, GoesOnWhereFingersReachIntoIt) {
  const model::Shape wide{ShapeKind::cylinder, {0.04, 0.04, 0.15}};
  const Pose X_WO = standing(wide), X_WG = side_grasp(wide, X_WO);
  const Features f = *features(tips({0.4, 0.4, 0.4, 0.4, 0.4}), 1);
  const FingerDistances fingers(barrett());
  int gone = 0, clear = 0, alone = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const MappingModel model = random_model(seed);
    Mapping mapping = *Mapping::create(barrett(), model, {});
    ASSERT_TRUE(mapping.on_state(state_at(base_at(X_WG), barrett().postures().at("open"), 0)));
    Expected<Command> last = fail("");
    for (int ms = 0; ms < 3000; ms += 33) {
      ASSERT_TRUE(mapping.on_detection(detection(wide, X_WO, ms)));
      last = mapping.on_posture(posture(X_WG, ms, 0.4), at(ms + 2));
      ASSERT_TRUE(last);
    }
    ASSERT_EQ(last->weight, 1);
    const Eigen::VectorXd answer =
        barrett().clamp(model.intelligent(f, wide, Pose::Identity())->dof);
    const Eigen::ArrayXd distances =
        fingers.distances(answer, wide, last->X_WB.inverse() * X_WO).array();
    double further = 0;  // rad, of the finger that has gone farthest
    for (Eigen::Index i = 0; i < answer.size(); ++i)
      further = std::max(further, barrett().dofs()[static_cast<std::size_t>(i)].closing *
                                      (last->dof[i] - answer[i]));
    EXPECT_LE(further, model::full_follow_through + 1e-9) << seed;
    gone += further > 0.1;
    // One finger of the answer reaches into it.
    alone += further > 0.1 && (distances < 0.003).count() == 1;
    if (distances.minCoeff() > 0.01) {
      ++clear;
      EXPECT_TRUE(last->dof.isApprox(answer, 1e-9)) << seed;
    }
  }
  EXPECT_GT(gone, 2);
  EXPECT_GT(clear, 2);
  EXPECT_GT(alone, 0);
}

TEST_F(MappingTest, CorrectsNoMoreThanThreeCentimetresAndTwentyDegrees) {
  const Pose X_WO = standing(talc);
  const Pose X_WG = side_grasp(talc, X_WO) *
                    make_pose(Eigen::Vector3d(0, 0.05, -0.10),
                              Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(X_WG), open_, 0)));
  Expected<Command> last = fail("");
  for (int ms = 0; ms < 2000; ms += 33) {
    ASSERT_TRUE(mapping_.on_detection(detection(talc, X_WO, ms)));
    last = mapping_.on_posture(posture(X_WG, ms), at(ms + 2));
  }
  const Pose commanded = last->X_WB * barrett().X_BG();
  EXPECT_EQ(last->weight, 1);
  EXPECT_NEAR((commanded.translation() - X_WG.translation()).norm(), 0.03, 1e-9);
  EXPECT_NEAR(angle_between(commanded.linear(), X_WG.linear()), 20 * M_PI / 180, 1e-5);
}

// Regression: the correction went straight to the grasp, so that its 3 cm were spent on the
// approach, and the fingers met the object from above before the hand was over it.
TEST_F(MappingTest, CorrectsSidewaysBeforeItHasArrived) {
  const Pose X_WO = standing(talc);
  const Pose X_WG = side_grasp(talc, X_WO) * make_pose(Eigen::Vector3d(-0.012, 0.016, -0.10));
  Mapping mapping = *Mapping::create(barrett(), model_, {.modes = {.intelligent = false}});
  ASSERT_TRUE(mapping.on_state(state_at(base_at(X_WG), open_, 0)));
  Expected<Command> last = fail("");
  for (int ms = 0; ms < 2000; ms += 33) {
    ASSERT_TRUE(mapping.on_detection(detection(talc, X_WO, ms)));
    last = mapping.on_posture(posture(X_WG, ms), at(ms));
  }
  // Along a cylinder any height is a grasp: 12 mm stay, 16 mm across it go, 10 cm are the
  // operator's.
  const Pose X_GG = X_WG.inverse() * last->X_WB * barrett().X_BG();
  EXPECT_NEAR(X_GG.translation().y(), -0.016, 1e-6);
  EXPECT_NEAR(X_GG.translation().x(), 0, 1e-6);
  EXPECT_NEAR(X_GG.translation().z(), 0, 1e-6);
}

// A single place is its own mean, so it is met but for rounding.
TEST_F(MappingTest, StandsWhereItLearntToStand) {
  const Pose X_WO = standing(talc);
  const Pose X_WG = side_grasp(talc, X_WO);
  const Eigen::Vector3d learnt(0, -0.012, 0.01);
  ModelTraits traits = model_.traits();
  traits.places = {{ShapeKind::cylinder, {0.05, 0.05, 0.1, 0}, learnt}};
  const auto model = MappingModel::create(barrett(), traits, model_.networks());
  ASSERT_TRUE(model) << model.error().message();
  for (const bool place : {true, false}) {
    Mapping mapping =
        *Mapping::create(barrett(), *model, {.modes = {.intelligent = false, .placement = place}});
    ASSERT_TRUE(mapping.on_state(state_at(base_at(X_WG), open_, 0)));
    Expected<Command> last = fail("");
    for (int ms = 0; ms < 2000; ms += 33) {
      ASSERT_TRUE(mapping.on_detection(detection(talc, X_WO, ms)));
      last = mapping.on_posture(posture(X_WG, ms), at(ms));
    }
    const Pose X_GG = X_WG.inverse() * last->X_WB * barrett().X_BG();
    const Eigen::Vector3d expected = place ? learnt : Eigen::Vector3d::Zero();
    EXPECT_NEAR((X_GG.translation() - expected).norm(), 0, 1e-6);
  }
}

TEST_F(MappingTest, TheHandYieldsToFingersThatComeFirst) {
  const MappingModel closing = closing_model();
  const FingerDistances fingers(barrett());
  const Pose X_WO = standing(talc);
  // Finger 3 comes first or fingers 1 and 2: never does one push while another is 2 cm away.
  const auto pushed = [&](bool place, double off) {
    const Pose X_WG = side_grasp(talc, X_WO) * make_pose(Eigen::Vector3d(0, off, 0));
    Mapping mapping = *Mapping::create(barrett(), closing, {.modes = {.placement = place}});
    EXPECT_TRUE(mapping.on_state(state_at(base_at(X_WG), open_, 0)).has_value());
    double deepest = 0;
    for (int ms = 0; ms < 6000; ms += 20) {
      EXPECT_TRUE(mapping.on_detection(detection(talc, X_WO, ms)).has_value());
      const auto command = mapping.on_posture(posture(X_WG, ms, 0.6), at(ms));
      const Eigen::VectorXd distances =
          fingers.distances(command->dof, talc, command->X_WB.inverse() * X_WO);
      if (distances.maxCoeff() > 0.02) deepest = std::min(deepest, distances.minCoeff());
    }
    return deepest;
  };
  EXPECT_LT(pushed(false, 0.02), -0.01);
  EXPECT_LT(pushed(false, -0.02), -0.01);
  for (const double off : {-0.02, 0.0, 0.02}) EXPECT_GT(pushed(true, off), -0.001) << off;
}

TEST_F(MappingTest, ReturnsToDirectWhenTheDetectionIsGone) {
  for (const bool disposed : {false, true}) {
    Mapping mapping = *Mapping::create(barrett(), model_, {});
    const Pose X_WO = standing(talc), X_WG = side_grasp(talc, X_WO);
    ASSERT_TRUE(mapping.on_state(state_at(base_at(X_WG), open_, 0)));
    for (int ms = 0; ms < 1000; ms += 20) {
      ASSERT_TRUE(mapping.on_detection(detection(talc, X_WO, ms)));
      ASSERT_TRUE(mapping.on_posture(posture(X_WG, ms), at(ms)));
    }
    EXPECT_EQ(mapping.phase(), Phase::engaged);
    if (disposed) mapping.on_detection_gone(1);
    double weight = 1;
    for (int ms = 1000; ms < 2000; ms += 20) {
      const auto answer = mapping.on_posture(posture(X_WG, ms), at(ms));
      ASSERT_TRUE(answer);
      EXPECT_LE(answer->weight, weight);
      weight = answer->weight;
      if (!disposed && ms <= 1480) {
        EXPECT_EQ(weight, 1) << "still fresh at " << ms;
      }
      if (ms >= (disposed ? 1320 : 1820)) {
        EXPECT_EQ(weight, 0) << ms;
      }
      if (weight == 0) {
        EXPECT_TRUE(answer->object.empty());
      }
    }
    EXPECT_EQ(mapping.phase(), Phase::direct);
  }
}

TEST_F(MappingTest, IsDirectOnlyWhenToldSo) {
  Mapping mapping =
      *Mapping::create(barrett(), model_, {.modes = {.intelligent = false, .placement = false}});
  const Pose X_WO = standing(talc), X_WG = side_grasp(talc, X_WO);
  ASSERT_TRUE(mapping.on_state(state_at(base_at(X_WG), open_, 0)));
  for (int ms = 0; ms < 1000; ms += 20) {
    ASSERT_TRUE(mapping.on_detection(detection(talc, X_WO, ms)));
    EXPECT_EQ(mapping.on_posture(posture(X_WG, ms), at(ms))->mode, Mode::direct);
  }
}

TEST_F(MappingTest, TheNearestObjectWinsAndStaysUntilAnotherIsClearlyNearer) {
  const Pose left = standing(talc, 0, 0.05), right = standing(talc, 0, -0.05);
  const auto run = [&](int from, int to, double y) {
    Pose X_WG = side_grasp(talc, standing(talc));
    X_WG.translation().y() = y;
    std::vector<std::string> objects;
    for (int ms = from; ms < to; ms += 20) {
      EXPECT_TRUE(mapping_.on_detection(detection(talc, left, ms, 1)));
      EXPECT_TRUE(mapping_.on_detection(detection(talc, right, ms, 2)));
      objects.push_back(mapping_.on_posture(posture(X_WG, ms), at(ms))->object);
    }
    return objects;
  };
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(side_grasp(talc, left)), open_, 0)));
  EXPECT_EQ(run(0, 1000, 0.04).back(), "object 1");
  // 1 cm beyond the middle is 2 cm nearer to the other: not enough.
  EXPECT_THAT(run(1000, 2000, -0.01), testing::Each("object 1"));
  const auto change = run(2000, 3000, -0.04);
  EXPECT_EQ(change.back(), "object 2");
  EXPECT_THAT(change, testing::Contains(""));  // through weight 0
}

TEST_F(MappingTest, AGripKeepsObjectAndPlacementWithoutACamera) {
  const Pose X_WO = standing(talc);
  Pose X_WG = side_grasp(talc, X_WO);
  X_WG.translation().y() += 0.015;
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(X_WG), open_, 0)));
  Expected<Command> last = fail("");
  int ms = 0;
  for (; ms < 1500; ms += 10) {
    ASSERT_TRUE(mapping_.on_detection(detection(talc, X_WO, ms)));
    last = mapping_.on_posture(posture(X_WG, ms, 0.5), at(ms));
  }
  // Something stops the fingers 0.1 rad before where they are told to be.
  Eigen::VectorXd stopped = last->dof;
  stopped.tail<3>().array() -= 0.1;
  for (; ms < 1800; ms += 10) {
    ASSERT_TRUE(mapping_.on_state(state_at(last->X_WB, stopped, ms)));
    last = mapping_.on_posture(posture(X_WG, ms, 0.5), at(ms));
  }
  ASSERT_EQ(mapping_.phase(), Phase::gripping);
  EXPECT_TRUE(((last->dof - stopped).tail<3>().array() >= 0.15 - 1e-9).all());
  const Pose correction = base_at(X_WG).inverse() * last->X_WB;
  // The hand lifts; the camera has lost the object for seconds, or sees it elsewhere.
  for (; ms < 6000; ms += 10) {
    X_WG.translation().z() += 0.0003;
    if (ms > 4000) {
      ASSERT_TRUE(mapping_.on_detection(detection(talc, standing(talc, 0.05, 0.06), ms)));
    }
    ASSERT_TRUE(mapping_.on_state(state_at(last->X_WB, stopped, ms)));
    last = mapping_.on_posture(posture(X_WG, ms, 0.5), at(ms));
    ASSERT_EQ(last->object, "object 1");
    ASSERT_EQ(last->weight, 1);
    ASSERT_TRUE((base_at(X_WG).inverse() * last->X_WB).isApprox(correction, 1e-6));
  }
}

TEST_F(MappingTest, HoldsWhenPosturesStop) {
  const Pose X_WG = make_pose(Eigen::Vector3d(0, 0, 0.3));
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(X_WG), open_, 0)));
  Expected<Command> last = fail("");
  for (int ms = 0; ms <= 300; ms += 30) {
    last = mapping_.on_posture(posture(X_WG, ms, 0.3), at(ms));
    EXPECT_FALSE(mapping_.tick(at(ms + 20)));
  }
  for (int ms = 360; ms < 2000; ms += 20) {
    const auto hold = mapping_.tick(at(ms));
    ASSERT_TRUE(hold) << ms;
    EXPECT_EQ(hold->mode, Mode::hold);
    EXPECT_EQ(hold->dof, last->dof);
    EXPECT_TRUE(hold->X_WB.isApprox(last->X_WB, 0));
    EXPECT_FALSE(hold->origin);
    EXPECT_EQ(hold->stamp, at(ms));
    // In lockstep a service may be asked again and again at one time, until nothing new comes.
    EXPECT_FALSE(mapping_.tick(at(ms)));
  }
  EXPECT_EQ(mapping_.on_posture(posture(X_WG, 2000), at(2000))->mode, Mode::direct);
}

TEST_F(MappingTest, RefusesBadPosturesAndThenHolds) {
  const Pose X_WG = make_pose(Eigen::Vector3d(0, 0, 0.3));
  ASSERT_TRUE(mapping_.on_state(state_at(base_at(X_WG), open_, 0)));
  const auto last = mapping_.on_posture(posture(X_WG, 0), at(0));
  ASSERT_TRUE(last);
  const auto reason = [&](const Posture& bad, Time now) {
    const auto answer = mapping_.on_posture(bad, now);
    return answer ? "answered" : answer.error().what;
  };
  Posture bad = posture(X_WG, 30);
  bad.fingertips[0].valid = false;
  EXPECT_EQ(reason(bad, at(30)), "fingertip missing");
  bad = posture(X_WG, 30);
  bad.X_WH.translation().z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(reason(bad, at(30)), "pose of the hand not finite");
  EXPECT_EQ(reason(posture(X_WG, 30), at(630)), "posture stale");
  EXPECT_EQ(reason(posture(X_WG, 1000), at(30)), "posture stale");
  ASSERT_TRUE(mapping_.tick(at(80)));
  EXPECT_EQ(mapping_.tick(at(100))->dof, last->dof);
}

TEST_F(MappingTest, RefusesBadDetectionsAndStates) {
  EXPECT_FALSE(mapping_.on_detection(detection({ShapeKind::unknown, {1, 1, 1}}, {}, 0)));
  EXPECT_FALSE(mapping_.on_detection(detection({ShapeKind::box, {1, -1, 1}}, {}, 0)));
  Detection doubtful = detection(talc, standing(talc), 0);
  doubtful.probability = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(mapping_.on_detection(doubtful));
  EXPECT_FALSE(mapping_.on_state(state_at(Pose::Identity(), Eigen::VectorXd::Zero(3), 0)));
  RobotState state = state_at(Pose::Identity(), open_, 0);
  state.torque[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(mapping_.on_state(state));
}

/// The weight that a still hand at the object comes to when detections are as uncertain as that.
double settled_weight(const MappingModel& model, const model::Shape& shape,
                      const Eigen::Vector4d& deviations, double size_flicker = 0) {
  Mapping mapping = *Mapping::create(barrett(), model, {});
  const Pose X_WO = standing(shape), X_WG = side_grasp(shape, X_WO);
  EXPECT_TRUE(
      mapping.on_state(state_at(base_at(X_WG), barrett().postures().at("open"), 0)).has_value());
  double weight = 0;
  for (int ms = 0; ms < 3000; ms += 33) {
    Detection seen = detection(shape, X_WO, ms);
    seen.shape.size *= 1 + (ms / 33 % 2 == 0 ? 1 : -1) * size_flicker;
    seen.covariance = deviations.cwiseAbs2().asDiagonal();
    EXPECT_TRUE(mapping.on_detection(seen).has_value());
    const auto answer = mapping.on_posture(posture(X_WG, ms, 0.4), at(ms));
    if (!answer) return -1;
    weight = answer->weight;
  }
  return weight;
}

// Inverse variances: as much as the tolerance is to the deviation, squared.
TEST_F(MappingTest, AnUncertainDetectionCountsLess) {
  const model::Shape box{ShapeKind::box, {0.04, 0.12, 0.20}};
  const auto position = [&](double sigma) {
    return settled_weight(model_, talc, {sigma, sigma / 2, 0.001, 0});
  };
  EXPECT_EQ(position(0), 1);
  EXPECT_EQ(position(0.01), 1);
  EXPECT_NEAR(position(0.02), 0.25, 1e-9);
  EXPECT_NEAR(position(0.1), 0.01, 1e-9);
  // A turned cylinder is the same cylinder, a turned box is not the same box.
  EXPECT_EQ(settled_weight(model_, talc, {0, 0, 0, 0.349}), 1);
  EXPECT_NEAR(settled_weight(model_, box, {0, 0, 0, 0.349}), 0.25, 1e-9);
}

TEST_F(MappingTest, ASizeThatVariesFromPictureToPictureCountsLess) {
  EXPECT_EQ(settled_weight(model_, talc, Eigen::Vector4d::Zero(), 0.1), 1);
  const double varying = settled_weight(model_, talc, Eigen::Vector4d::Zero(), 0.5);
  // Its deviation is near 0.5 and the tolerance 0.2: about 0.16.
  EXPECT_GT(varying, 0.10);
  EXPECT_LT(varying, 0.25);
}

TEST_F(MappingTest, RefusesACovarianceThatIsNone) {
  Detection bad = detection(talc, standing(talc), 0);
  bad.covariance(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(mapping_.on_detection(bad));
  bad.covariance = -Eigen::Matrix4d::Identity();
  EXPECT_FALSE(mapping_.on_detection(bad));
}

TEST_F(MappingTest, PlacementAndFingersCanBeImprovedApart) {
  const Pose X_WO = standing(talc);
  const Pose X_WG = side_grasp(talc, X_WO) * make_pose(Eigen::Vector3d(0, 0.02, 0));
  for (const bool intelligent : {false, true})
    for (const bool place : {false, true}) {
      Mapping mapping = *Mapping::create(
          barrett(), model_, {.modes = {.intelligent = intelligent, .placement = place}});
      ASSERT_TRUE(mapping.on_state(state_at(base_at(X_WG), open_, 0)));
      Expected<Command> last = fail("");
      for (int ms = 0; ms < 3000; ms += 33) {
        ASSERT_TRUE(mapping.on_detection(detection(talc, X_WO, ms)));
        last = mapping.on_posture(posture(X_WG, ms, 0.4), at(ms));
      }
      const double moved = (last->X_WB.translation() - base_at(X_WG).translation()).norm();
      if (intelligent && place)
        EXPECT_GT(moved, 0.001) << "and the hand may yield to the fingers";
      else
        EXPECT_NEAR(moved, place ? 0.02 : 0, 1e-6);
      const Features f = *features(tips({0.4, 0.4, 0.4, 0.4, 0.4}), 1);
      const NetworkAnswer expected =
          intelligent ? *model_.intelligent(f, talc, Pose::Identity()) : model_.direct(f);
      EXPECT_TRUE(last->dof.isApprox(barrett().clamp(expected.dof), 1e-9));
    }
}

TEST_F(MappingTest, GivesTheSameAnswersAgain) {
  Mapping again = *Mapping::create(barrett(), model_, {});
  for (Mapping* mapping : {&mapping_, &again})
    ASSERT_TRUE(mapping->on_state(state_at(Pose::Identity(), open_, 0)));
  Random random(9);
  for (int ms = 0; ms < 5000; ms += 33) {
    const Pose X_WG = make_pose(random.normal3(0.1));
    const double closure = random.uniform();
    for (Mapping* mapping : {&mapping_, &again})
      (void)mapping->on_detection(detection(talc, standing(talc), ms));
    const auto a = mapping_.on_posture(posture(X_WG, ms, closure), at(ms));
    const auto b = again.on_posture(posture(X_WG, ms, closure), at(ms));
    ASSERT_TRUE(a && b);
    ASSERT_EQ(a->dof, b->dof);
    ASSERT_EQ(a->X_WB.matrix(), b->X_WB.matrix());
  }
}

}  // namespace
}  // namespace prehend::mapping
