// What is said about a demonstration, from messages made here. Distances are computed by hand; the
// tolerance of 1e-12 m is rounding.
#include "services/cli/service/observer.hpp"

#include <gtest/gtest.h>

#include "common/convert/convert.hpp"

namespace prehend::cli {
namespace {

model::Scene truth() {
  model::Scene scene;
  scene.demonstrator.target = "Talc";
  scene.objects = {{"Talc", make_pose(Eigen::Vector3d(0.10, 0.00, 0.05))},
                   {"Cup", make_pose(Eigen::Vector3d(-0.30, 0.20, 0.05))}};
  return scene;
}

v1::ObjectDetection detection(const std::string& name, double x, double y, std::int64_t stamp,
                              double probability = 0.9) {
  v1::ObjectDetection message;
  message.name(name);
  message.shape(v1::SHAPE_CYLINDER);
  message.size(convert::to_message(Eigen::Vector3d(0.024, 0.024, 0.105)));
  message.X_WO(convert::to_message(make_pose(Eigen::Vector3d(x, y, 0.3))));
  message.stamp_ns(stamp);
  message.probability(probability);
  return message;
}

v2::HandCommand command(v1::MappingMode mode, double weight, const std::string& object) {
  v2::HandCommand message;
  message.model("barrett");
  message.mode(mode);
  message.weight(weight);
  message.object(object);
  message.X_WB(convert::to_message(make_pose(Eigen::Vector3d(0.1, 0, 0.2))));
  return message;
}

v1::GraspReport report(const std::string& believed, bool held, std::int64_t stamp) {
  v1::GraspReport message;
  message.object("Talc");
  message.believed_object(believed);
  message.stamp_ns(stamp);
  message.mode(v1::MODE_INTELLIGENT);
  message.weight(0.75);
  message.grasp_type(v1::GRASP_POWER_WRAP);
  message.contacts().resize(6);
  message.epsilon(0.04);
  message.force_closure(true);
  message.held(held);
  message.X_BO(convert::to_message(make_pose(Eigen::Vector3d(0, 0, -0.15))));
  return message;
}

v1::ServiceStatus status(const std::string& name, std::int64_t stamp) {
  v1::ServiceStatus message;
  message.service(name + "@here/1");
  message.name(name);
  message.stamp_ns(stamp);
  message.state(v1::STATE_RUNNING);
  return message;
}

TEST(Observer, NothingHeardIsNoGraspAndNoObject) {
  const Outcome outcome = Observer().outcome();
  EXPECT_FALSE(outcome.object);
  EXPECT_FALSE(outcome.judged);
  EXPECT_FALSE(outcome.grasp.held);
  EXPECT_EQ(outcome.grasp.contacts, 0);
  EXPECT_EQ(outcome.grasp.epsilon, -1);
  EXPECT_EQ(outcome.mode, v1::MODE_HOLD);
  EXPECT_FALSE(outcome.latency);
}

TEST(Observer, PositionErrorIsHorizontalAgainstTheSameObject) {
  Observer observer(truth());
  observer.hear(detection("Talc", 0.103, 0.004, 10));  // 3-4-5; its height does not matter
  const Outcome outcome = observer.outcome();
  ASSERT_TRUE(outcome.object);
  ASSERT_TRUE(outcome.object->position_error);
  EXPECT_NEAR(*outcome.object->position_error, 0.005, 1e-12);
  EXPECT_EQ(outcome.object->shape.kind, model::ShapeKind::cylinder);
  EXPECT_EQ(outcome.target, "Talc");
}

TEST(Observer, AWrongNameIsComparedWithTheNearest) {
  Observer observer(truth());
  observer.hear(detection("Vitamins", 0.10, 0.01, 10));
  EXPECT_NEAR(*observer.outcome().object->position_error, 0.01, 1e-12);
}

TEST(Observer, WithoutTruthThereIsNoError) {
  Observer observer;
  observer.hear(detection("Talc", 0, 0, 10));
  ASSERT_TRUE(observer.outcome().object);
  EXPECT_FALSE(observer.outcome().object->position_error);
  EXPECT_EQ(observer.outcome().target, "");
}

TEST(Observer, TheObjectIsWhatTheMappingBelievedUpToClosure) {
  Observer observer(truth());
  observer.hear(detection("Cup", -0.3, 0.2, 90, 0.99));
  observer.hear(detection("Talc", 0.10, 0.01, 90, 0.8));
  observer.hear(detection("Talc", 0.10, 0.02, 100, 0.8));
  observer.hear(command(v1::MODE_INTELLIGENT, 0.9, "Talc"));
  observer.hear(report("Talc", true, 150));
  observer.hear(detection("Talc", 0.50, 0.50, 200, 0.8));  // carried away after closure
  const Outcome outcome = observer.outcome();
  EXPECT_EQ(outcome.object->name, "Talc");
  EXPECT_NEAR(*outcome.object->position_error, 0.02, 1e-12);
}

TEST(Observer, WithoutABeliefItIsTheNearestToWhatWasGrasped) {
  Observer observer(truth());
  observer.hear(detection("Cup", -0.3, 0.2, 90, 0.99));
  observer.hear(detection("Talc", 0.11, 0.0, 90, 0.6));
  observer.hear(command(v1::MODE_DIRECT, 0, ""));
  observer.hear(report("", true, 150));  // grasped at x 0.1
  EXPECT_EQ(observer.outcome().object->name, "Talc");
}

TEST(Observer, WithoutAGraspItIsTheSurest) {
  Observer observer(truth());
  observer.hear(detection("Talc", 0.11, 0.0, 90, 0.6));
  observer.hear(detection("Cup", -0.3, 0.2, 90, 0.99));
  EXPECT_EQ(observer.outcome().object->name, "Cup");
}

TEST(Observer, TheFirstGraspCountsAndItsModeIsThatAtClosure) {
  Observer observer(truth());
  observer.hear(command(v1::MODE_DIRECT, 0.1, ""));
  observer.hear(report("Talc", false, 100));
  observer.hear(command(v1::MODE_HOLD, 0, ""));
  observer.hear(report("Talc", true, 200));
  const Outcome outcome = observer.outcome();
  EXPECT_FALSE(outcome.grasp.held);
  EXPECT_EQ(outcome.mode, v1::MODE_INTELLIGENT);
  EXPECT_EQ(outcome.weight, 0.75);
  EXPECT_EQ(outcome.grasp_type, v1::GRASP_POWER_WRAP);
  EXPECT_EQ(outcome.grasp.contacts, 6);
}

TEST(Observer, WithoutAGraspTheModeIsThatOfTheLastCommandThatFollowed) {
  Observer observer;
  observer.hear(command(v1::MODE_HOLD, 0, ""));
  EXPECT_FALSE(observer.commanded());
  observer.hear(command(v1::MODE_DIRECT, 0, ""));
  observer.hear(command(v1::MODE_INTELLIGENT, 0.5, "Cup"));
  observer.hear(command(v1::MODE_HOLD, 0, ""));  // the recording is over
  EXPECT_TRUE(observer.commanded());
  EXPECT_EQ(observer.outcome().mode, v1::MODE_INTELLIGENT);
  EXPECT_EQ(observer.outcome().weight, 0.5);
}

// Beside much load the glove was late at the moment of closure: the grasp was «held, mode hold».
TEST(Observer, AHandThatClosedWhileItHeldWasLedBefore) {
  Observer observer;
  observer.hear(command(v1::MODE_INTELLIGENT, 0.5, "Cup"));
  v1::GraspReport late = report("Cup", true, 100);
  late.mode(v1::MODE_HOLD);
  late.weight(0);
  observer.hear(late);
  EXPECT_EQ(observer.outcome().mode, v1::MODE_INTELLIGENT);
  EXPECT_EQ(observer.outcome().weight, 0.5);
}

TEST(Observer, FramesLostOnTheWayCountToo) {
  Observer observer;
  v1::GloveFrame frame;
  frame.device("synthetic");
  for (const std::uint64_t number : {0u, 1u, 9u, 4u}) {
    frame.sequence_number(number);
    observer.hear(frame);
  }
  EXPECT_EQ(observer.outcome().frames, 10u);
  EXPECT_EQ(observer.outcome().device, "synthetic");
}

TEST(Observer, RejectedAreTheGlovesDropsOfAllReasons) {
  Observer observer;
  v1::ServiceStatus glove = status("glove", 1);
  glove.drops().resize(2);
  glove.drops()[0].count(3);
  glove.drops()[1].count(4);
  observer.hear(glove);
  EXPECT_EQ(observer.outcome().rejected, 7u);
}

TEST(Observer, LatencyIsInOnceToldAfterClosure) {
  Observer observer;
  v1::ServiceStatus simulation = status("simulation", 100);
  simulation.latency().resize(1);
  simulation.latency()[0].stage("glove to accepted");
  simulation.latency()[0].p50_us(1500);
  simulation.latency()[0].p99_us(4000);
  simulation.latency()[0].count(5);
  observer.hear(simulation);
  EXPECT_FALSE(observer.latency_is_in()) << "nothing was grasped yet";
  observer.hear(report("", true, 150));
  EXPECT_FALSE(observer.latency_is_in()) << "older than closure";
  simulation.stamp_ns(200);
  observer.hear(simulation);
  EXPECT_TRUE(observer.latency_is_in());
  EXPECT_NEAR(observer.outcome().latency->p50, 1.5, 1e-12);
  EXPECT_NEAR(observer.outcome().latency->p99, 4.0, 1e-12);
}

TEST(Observer, AServiceIsUpWhileItSaysSo) {
  Observer observer;
  v1::ServiceStatus mapping = status("mapping", 1);
  mapping.state(v1::STATE_STARTING);
  observer.hear(mapping);
  EXPECT_FALSE(observer.is_up("mapping"));
  mapping.state(v1::STATE_DEGRADED);
  observer.hear(mapping);
  EXPECT_TRUE(observer.is_up("mapping"));
  EXPECT_FALSE(observer.is_up("glove"));
  observer.lost_service("mapping@here/1");
  EXPECT_FALSE(observer.is_up("mapping"));
}

v1::ArmState arm_state(double speed, v1::ArmHindrance hindrance) {
  v1::ArmState message;
  message.velocity({0.1, -speed});
  message.hindrance(hindrance);
  return message;
}

TEST(Observer, OfAnArmTellsTheFastestJointAndHowLongItWasHindered) {
  Observer observer;
  observer.hear(arm_state(1, v1::HINDRANCE_REACH));
  EXPECT_FALSE(observer.outcome().arm) << "of which nobody told";
  model::ArmModel model;
  model.name = "puma560";
  model.joints.resize(2);
  model.joints[0].velocity = 1;
  model.joints[1].velocity = 2;
  observer.expect_arm(model);
  observer.hear(arm_state(0.5, v1::HINDRANCE_NONE));
  observer.hear(arm_state(1.5, v1::HINDRANCE_ON_THE_WAY));
  observer.hear(arm_state(1.0, v1::HINDRANCE_REACH));
  observer.hear(arm_state(0.5, v1::HINDRANCE_NO_WISH));
  observer.hear(report("Talc", true, 5));
  observer.hear(arm_state(2, v1::HINDRANCE_COLLISION));  // another story
  const auto arm = observer.outcome().arm;
  ASSERT_TRUE(arm);
  EXPECT_EQ(arm->name, "puma560");
  EXPECT_EQ(arm->worst_joint_speed, 0.75);
  EXPECT_EQ(arm->out_of_reach, 0.25);
}

v1::ObjectDetection tracked(std::uint32_t track, const std::string& name, std::int64_t stamp) {
  v1::ObjectDetection message = detection(name, 0.1 * track, 0, stamp);
  message.track(track);
  return message;
}

v2::GraspCandidates candidates(std::uint32_t track, std::size_t count, bool complete,
                               std::int64_t stamp, const std::string& reason = "") {
  v2::GraspCandidates message;
  message.track(track);
  message.candidates().resize(count);
  message.complete(complete);
  message.stamp_ns(stamp);
  message.reason(reason);
  return message;
}

constexpr std::int64_t second = 1'000'000'000;

// Who waits for plans reaches neither before anything is seen nor while one is looked for.
TEST(Observer, PlannedIsWhenAllThatIsSeenIs) {
  Observer observer(truth());
  EXPECT_FALSE(observer.planned());
  EXPECT_EQ(observer.unplanned(), "");
  observer.hear(tracked(1, "Talc", second));
  observer.hear(tracked(2, "Cup", second));
  observer.hear(candidates(1, 3, true, second));
  EXPECT_FALSE(observer.planned());
  observer.hear(candidates(2, 1, false, second));
  EXPECT_FALSE(observer.planned());
  EXPECT_EQ(observer.unplanned(), "Cup");
  observer.hear(candidates(2, 1, true, second));
  EXPECT_TRUE(observer.planned());
  EXPECT_TRUE(observer.without_plan().empty());
}

// It waited for ever for what the planner refuses.
TEST(Observer, WhatGetsNoPlanIsNotAwaited) {
  Observer observer(truth());
  observer.hear(tracked(1, "Talc", second));
  observer.hear(candidates(1, 0, true, second, "detection not probable"));
  EXPECT_FALSE(observer.planned()) << "the next picture may be surer";
  observer.hear(candidates(1, 0, false, 2 * second));
  observer.hear(tracked(1, "Talc", 3 * second));
  EXPECT_FALSE(observer.planned()) << "it was: one is looked for after all";
  observer.hear(candidates(1, 0, true, second, "does not fit into the hand"));
  EXPECT_TRUE(observer.planned());
  ASSERT_EQ(observer.without_plan().size(), 1u);
  EXPECT_EQ(observer.without_plan().front(),
            std::pair(std::string("Talc"), std::string("does not fit into the hand")));
}

// Nor for a name under which nothing is seen any more.
TEST(Observer, WhatIsGoneOrTakenForSomethingElseIsNotAwaited) {
  Observer observer(truth());
  observer.hear(tracked(1, "Kitkat", second));
  observer.hear(tracked(1, "Talc", 2 * second));
  observer.hear(tracked(2, "Cup", second));
  observer.hear(candidates(1, 3, true, 2 * second));
  EXPECT_EQ(observer.unplanned(), "Cup");
  observer.lost_object(2);
  EXPECT_TRUE(observer.planned());
  observer.lost_object(1);
  EXPECT_FALSE(observer.planned()) << "nothing is there";
}

}  // namespace
}  // namespace prehend::cli
