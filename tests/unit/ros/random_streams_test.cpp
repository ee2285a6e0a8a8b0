// Random streams of what nodes tell: trajectories and poses, late, early, damaged, of several nodes
// at once, with leaps, nonsense and other robots' joints. Whatever comes, what leaves the gate
// keeps the hand's limits.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "common/base/random.hpp"
#include "common/gate/command_gate.hpp"
#include "services/ros/core/one_speaker.hpp"
#include "services/ros/core/trajectory_follower.hpp"
#include "services/ros/core/wrist_goal.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/way.hpp"

namespace prehend::ros {
namespace {

using std::chrono::milliseconds;

const Time beginning = from_ns(1'700'000'000'000'000'000);

ros2::Bytes random_trajectory(Random& random, const model::HandModel& hand, Time now) {
  ros2::JointTrajectory made;
  if (random.uniform() < 0.5)
    made.stamp_ns = to_ns(now + seconds(random.normal(random.uniform() < 0.2 ? 20 : 0.5)));
  for (const model::HandDof& dof : hand.dofs())
    made.names.push_back(hand.joints()[static_cast<std::size_t>(dof.joint)].name);
  if (random.uniform() < 0.1) made.names[random.index(made.names.size())] = "elbow";
  if (random.uniform() < 0.05) made.names.pop_back();
  Duration after{};
  for (std::size_t i = random.index(5); i > 0; --i) {
    after += seconds(random.uniform(-0.05, 0.5));
    ros2::JointTrajectory::Point point{{}, after};
    for (std::size_t d = 0; d < made.names.size(); ++d) {
      const model::HandDof& dof = hand.dofs()[d];
      point.positions.push_back(random.uniform() < 0.01 ? std::numeric_limits<double>::quiet_NaN()
                                                        : dof.lower + random.uniform(-0.01, 1.01) *
                                                                          (dof.upper - dof.lower));
    }
    made.points.push_back(point);
  }
  return ros2::joint_trajectory(made);
}

ros2::Bytes random_pose(Random& random, Time now) {
  ros2::StampedPose made;
  made.frame = random.uniform() < 0.1 ? "base_link" : table_frame;
  if (random.uniform() < 0.5)
    made.stamp_ns = to_ns(now + seconds(random.normal(random.uniform() < 0.2 ? 5 : 0.05)));
  made.X_FB =
      make_pose(random.normal3(random.uniform() < 0.1 ? 1e3 : 0.3),
                Eigen::AngleAxisd(random.normal(1), Eigen::Vector3d::UnitX()).toRotationMatrix());
  return ros2::pose_stamped(made);
}

/// What prehend-ros-lead does of each message, without the lab around it.
class Lead {
 public:
  Lead(const model::HandModel& hand, Pose X_WB) : hand_(hand), follower_(hand), X_WB_(X_WB) {}

  void hear(int node, std::span<const std::uint8_t> bytes, Time now) {
    const Eigen::VectorXd here = hand_.postures().at("open");
    if (const auto trajectory = ros2::parse_joint_trajectory(bytes))
      if (trajectory->points.empty() || speaker_.hear(node, now))
        (void)follower_.take(*trajectory, here, now);
    const auto pose = ros2::parse_pose_stamped(bytes).and_then(
        [&](const ros2::StampedPose& told) { return wrist_goal(told, now); });
    if (!pose || !speaker_.hear(node, now)) return;
    follower_.hold(here, now);
    X_WB_ = *pose;
  }
  std::optional<gate::Command> command(Time now) {
    const auto dof = follower_.goal(now);
    if (!dof) return std::nullopt;
    return gate::Command{{}, ++sequence_, now, "hand", hand_.name(), {*dof, X_WB_}};
  }

 private:
  const model::HandModel& hand_;
  TrajectoryFollower follower_;
  OneSpeaker<int> speaker_;
  Pose X_WB_;
  std::uint64_t sequence_ = 0;
};

class RosStreams : public testing::TestWithParam<std::string> {};

TEST_P(RosStreams, NeverLeadAHandBeyondItsLimits) {
  const model::HandModel& hand = test::hand(GetParam());
  const std::size_t hands = test::hand_names().size();
  const std::size_t all = std::getenv("PREHEND_LONG") ? 10'000 : 200;
  int passed = 0;
  for (std::uint64_t seed = 0; seed < (all + hands - 1) / hands; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const gate::Limits limits = gate::limits_of(hand);
    std::optional<gate::Place> last =
        gate::Place{hand.postures().at("open"), make_pose({0, 0, 0.5})};
    auto gate = gate::CommandGate::create(hand, {.hand = "hand"}, limits, [&] { return last; });
    ASSERT_TRUE(gate);
    Lead lead(hand, last->X_WB);
    std::vector<test::Way> joints;
    for (const gate::MotionLimit& joint : limits.joint) joints.emplace_back(joint.speed);
    test::Way base(limits.base.speed);
    for (Time now = beginning; now < beginning + seconds(2); now += milliseconds(10)) {
      if (random.uniform() < 0.15) {
        ros2::Bytes bytes = random.uniform() < 0.5 ? random_trajectory(random, hand, now)
                                                   : random_pose(random, now);
        if (random.uniform() < 0.1)
          bytes[random.index(bytes.size())] ^= static_cast<std::uint8_t>(1 << random.index(8));
        lead.hear(static_cast<int>(random.index(3)), bytes, now);
      }
      const auto command = lead.command(now);
      if (!command) continue;
      const auto through = gate->admit(*command, now);
      if (!through) continue;
      const gate::Place& place = through->place;
      EXPECT_TRUE(place.dof.allFinite() && is_finite(place.X_WB));
      EXPECT_LE((place.dof - limits.upper).maxCoeff(), 0);
      EXPECT_GE((place.dof - limits.lower).minCoeff(), 0);
      const double t = to_seconds(now - beginning);
      for (std::size_t d = 0; d < joints.size(); ++d) {
        const auto k = static_cast<Eigen::Index>(d);
        joints[d].go(std::abs(place.dof[k] - last->dof[k]), t);
      }
      base.go((place.X_WB.translation() - last->X_WB.translation()).norm(), t);
      last = place;
      ++passed;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(passed, 500) << "what refuses everything keeps all limits";
}

INSTANTIATE_TEST_SUITE_P(AllHands, RosStreams, testing::ValuesIn(test::hand_names()),
                         [](const auto& hand) { return hand.param; });

}  // namespace
}  // namespace prehend::ros
