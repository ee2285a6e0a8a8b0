// Trajectories of nodes as a joint_trajectory_controller takes them, over all hands: between the
// points on straight lines, replaced without a leap, ended by an empty one; and whatever is wrong
// with one is refused and moves nothing.
#include "services/ros/core/trajectory_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/support/hands.hpp"

namespace prehend::ros {
namespace {

using Eigen::VectorXd;
using std::chrono::milliseconds;

const Time start = from_ns(1'700'000'000'000'000'000);

/// Points of random values within the hand's ranges, 1 to 400 ms from one to the next; its joints
/// in any order.
class Nodes {
 public:
  Nodes(const model::HandModel& hand, unsigned seed) : hand_(hand), random_(seed) {
    for (std::size_t d = 0; d < hand.dofs().size(); ++d) order_.push_back(d);
    std::shuffle(order_.begin(), order_.end(), random_);
  }

  VectorXd place() {
    VectorXd made(static_cast<Eigen::Index>(hand_.dofs().size()));
    for (Eigen::Index d = 0; d < made.size(); ++d) {
      const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(d)];
      made[d] = std::uniform_real_distribution(dof.lower, dof.upper)(random_);
    }
    return made;
  }
  Duration wait() { return milliseconds(std::uniform_int_distribution(1, 400)(random_)); }

  ros2::JointTrajectory trajectory(const std::vector<VectorXd>& places) {
    ros2::JointTrajectory made;
    for (const std::size_t d : order_)
      made.names.push_back(hand_.joints()[static_cast<std::size_t>(hand_.dofs()[d].joint)].name);
    Duration at{};
    for (const VectorXd& place : places) {
      auto& point = made.points.emplace_back();
      for (const std::size_t d : order_)
        point.positions.push_back(place[static_cast<Eigen::Index>(d)]);
      point.time_from_start = at += wait();
    }
    return made;
  }

 private:
  const model::HandModel& hand_;
  std::mt19937 random_;
  std::vector<std::size_t> order_;
};

class Follower : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  const VectorXd open_ = hand_.postures().at("open");
  TrajectoryFollower follower_{hand_};
  Nodes nodes_{hand_, 7};

  /// Refused with these words, and what was followed goes on.
  void expect_refused(const ros2::JointTrajectory& trajectory, const std::string& words) {
    const Time later = start + milliseconds(5);
    const auto before = follower_.goal(later);
    const auto taken = follower_.take(trajectory, open_, start);
    ASSERT_FALSE(taken) << words;
    EXPECT_NE(taken.error().what.find(words), std::string::npos) << taken.error().what;
    EXPECT_EQ(follower_.goal(later), before) << words;
  }
};

TEST_P(Follower, GoesFromPointToPointAndStaysAtTheLast) {
  for (int round = 0; round < 20; ++round) {
    follower_.stop();
    const VectorXd here = nodes_.place();
    const std::vector<VectorXd> places{nodes_.place(), nodes_.place(), nodes_.place()};
    const auto trajectory = nodes_.trajectory(places);
    ASSERT_TRUE(follower_.take(trajectory, here, start));
    EXPECT_TRUE(follower_.goal(start)->isApprox(here, 1e-12));
    VectorXd from = here;
    Duration since{};
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Duration until = trajectory.points[i].time_from_start;
      const Duration between = since + (until - since) / 4;
      const double share = to_seconds(between - since) / to_seconds(until - since);
      EXPECT_LT((*follower_.goal(start + between) - (from + share * (places[i] - from))).norm(),
                1e-9);
      EXPECT_LT((*follower_.goal(start + until) - places[i]).norm(), 1e-9);
      from = places[i];
      since = until;
    }
    EXPECT_EQ(*follower_.goal(start + std::chrono::hours(1)), places.back());
  }
}

TEST_P(Follower, ANewOneReplacesTheOldWithoutALeap) {
  VectorXd last = nodes_.place();
  Time now = start;
  for (int round = 0; round < 50; ++round) {
    const std::vector<VectorXd> places{nodes_.place(), nodes_.place()};
    ASSERT_TRUE(follower_.take(nodes_.trajectory(places), open_, round == 0 ? start : now));
    EXPECT_LT((*follower_.goal(now) - (round == 0 ? hand_.clamp(open_) : last)).norm(), 1e-9);
    now += nodes_.wait();
    last = *follower_.goal(now);
    EXPECT_LT((hand_.clamp(last) - last).norm(), 1e-9);
  }
}

TEST_P(Follower, AnEmptyOneEndsIt) {
  ASSERT_TRUE(follower_.take(nodes_.trajectory({nodes_.place()}), open_, start));
  ASSERT_TRUE(follower_.goal(start));
  ASSERT_TRUE(follower_.take({}, open_, start));
  EXPECT_FALSE(follower_.goal(start));
}

// One that began a while ago is joined where it is by now: nothing leaps, nothing is made up for.
TEST_P(Follower, AStampSaysWhenItBegan) {
  const std::vector<VectorXd> places{nodes_.place(), nodes_.place()};
  auto trajectory = nodes_.trajectory(places);
  trajectory.points[0].time_from_start = milliseconds(100);
  trajectory.points[1].time_from_start = milliseconds(1000);
  trajectory.stamp_ns = to_ns(start - milliseconds(500));
  ASSERT_TRUE(follower_.take(trajectory, open_, start));
  EXPECT_LT((*follower_.goal(start) - hand_.clamp(open_)).norm(), 1e-9);
  const VectorXd half = (hand_.clamp(open_) + places[1]) / 2;
  EXPECT_LT((*follower_.goal(start + milliseconds(250)) - half).norm(), 1e-9);
  EXPECT_EQ(*follower_.goal(start + milliseconds(500)), places[1]);
}

TEST_P(Follower, APointOfTimeZeroIsWhereToBeAtOnce) {
  const VectorXd place = nodes_.place();
  auto trajectory = nodes_.trajectory({place});
  trajectory.points[0].time_from_start = {};
  ASSERT_TRUE(follower_.take(trajectory, open_, start));
  EXPECT_EQ(*follower_.goal(start), place);
}

TEST_P(Follower, WhatIsWrongIsRefusedAndMovesNothing) {
  const auto good = nodes_.trajectory({nodes_.place(), nodes_.place()});
  for (const bool follows : {false, true}) {
    if (follows) {
      ASSERT_TRUE(follower_.take(good, open_, start));
    }
    auto bad = good;
    bad.names[0] = "no\x1bsuch";
    expect_refused(bad, "does not name the joint " + good.names[0]);
    bad = good;
    bad.names.push_back("no\x1bsuch");
    for (auto& point : bad.points) point.positions.push_back(0);
    expect_refused(bad, "names «no\\x1bsuch», a joint that leads no DoF of " + hand_.name());
    bad = good;
    const model::HandDof& dof = hand_.dofs()[0];
    const std::string joint = hand_.joints()[static_cast<std::size_t>(dof.joint)].name;
    const auto at = std::find(bad.names.begin(), bad.names.end(), joint) - bad.names.begin();
    bad.points[1].positions[static_cast<std::size_t>(at)] =
        dof.upper + 0.02 * (dof.upper - dof.lower);
    expect_refused(bad, "outside its range");
    bad = good;
    bad.stamp_ns = to_ns(start + std::chrono::seconds(11));
    expect_refused(bad, "away from now");
    bad.stamp_ns = std::numeric_limits<std::int64_t>::min() / 4;
    expect_refused(bad, "away from now");
    bad.stamp_ns = to_ns(start - std::chrono::seconds(2));
    expect_refused(bad, "is over already");
  }
}

INSTANTIATE_TEST_SUITE_P(Hands, Follower, testing::ValuesIn(test::hand_names()));

}  // namespace
}  // namespace prehend::ros
