// Random streams of commands, for every hand: two writers on a network that delays, doubles and
// swaps, that send leaps, nonsense and commands for others, and fall silent. Whatever they do, what
// leaves the gate keeps the limits, is young, comes once and in order, and has one leader at a
// time. A sound stream, as mapping makes it, leaves as it came.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <tuple>

#include "common/base/random.hpp"
#include "common/model/hand_effort.hpp"
#include "tests/support/way.hpp"
#include "tests/unit/gate/fixtures.hpp"

namespace prehend::gate {
namespace {

using Eigen::Vector3d;
using test::Way;

struct Sent {
  Command command;
  Time arrives{};
};

std::vector<Sent> wild(Random& random, const model::HandModel& hand) {
  std::vector<Sent> all;
  for (std::uint8_t from = 1; from <= 2; ++from) {
    Place place = open_at(hand, random.normal3(0.3));
    std::uint64_t sequence = random.index(5);
    for (int ms = static_cast<int>(random.index(500)); ms < 3000;) {
      if (random.uniform() < 0.03) ms += static_cast<int>(random.index(900));  // silence
      ms += 2 + static_cast<int>(random.index(40));
      place.X_WB.translation() += random.normal3(random.uniform() < 0.1 ? 1 : 0.02);
      place.X_WB.linear() *=
          Eigen::AngleAxisd(random.normal(random.uniform() < 0.1 ? 2 : 0.05), Vector3d::UnitX())
              .toRotationMatrix();
      for (double& dof : place.dof) dof += random.normal(random.uniform() < 0.1 ? 1 : 0.05);
      place.dof = hand.clamp(place.dof);
      place.effort.resize(0);
      if (random.uniform() < 0.7) {
        place.effort = model::max_effort(hand);
        for (double& effort : place.effort) effort *= random.uniform(0, 1.5);
      }
      Command command{writer(from), ++sequence, at(ms), "hand", hand.name(), place};
      const double fault = random.uniform();
      if (fault < 0.02)
        command.place.dof[0] = std::numeric_limits<double>::quiet_NaN();
      else if (fault < 0.04)
        command.place.X_WB.translation().setConstant(1e6);
      else if (fault < 0.05)
        command.hand = "other";
      else if (fault < 0.06)
        command.model = "other";
      else if (fault < 0.07)
        command.place.dof.conservativeResize(command.place.dof.size() + 1);
      else if (fault < 0.075)
        command.place.effort = Eigen::VectorXd::Constant(place.dof.size(), -1);
      else if (fault < 0.08)
        command.place.effort =
            Eigen::VectorXd::Constant(place.dof.size(), std::numeric_limits<double>::quiet_NaN());
      else if (fault < 0.0825)
        command.place.effort =
            Eigen::VectorXd::Constant(place.dof.size(), std::numeric_limits<double>::infinity());
      else if (fault < 0.085)
        command.place.effort = Eigen::VectorXd::Ones(place.dof.size() + 1);
      else if (fault < 0.115)
        command.stamp += seconds(random.uniform(-1, 1));
      else if (fault < 0.125)
        command.sequence += random.index(1000);
      const Duration delay = seconds(random.uniform() < 0.2 ? random.uniform(0, 0.3) : 0.005);
      all.push_back({command, at(ms) + delay});
      if (random.uniform() < 0.1) all.push_back({command, at(ms) + delay + seconds(0.02)});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Sent& a, const Sent& b) { return a.arrives < b.arrives; });
  return all;
}

Limits random_limits(Random& random, const model::HandModel& hand) {
  Limits limits = limits_of(hand);
  if (random.uniform() < 0.5) return limits;
  for (MotionLimit& joint : limits.joint) joint = {random.uniform(0.1, 3), random.uniform(0.1, 30)};
  for (double& effort : limits.effort) effort *= random.uniform(0.1, 1);
  limits.base = {random.uniform(0.1, 1), random.uniform(0.1, 30)};
  limits.turn = {random.uniform(0.1, 3), random.uniform(0.1, 30)};
  limits.box_lower = {-0.5, -0.5, 0};
  limits.box_upper = {0.5, 0.5, 1};
  return limits;
}

/// Looks at everything that passes.
class Watch {
 public:
  explicit Watch(const Limits& limits)
      : limits_(limits), base_(limits.base.speed), turn_(limits.turn.speed) {
    for (const MotionLimit& joint : limits.joint) joints_.emplace_back(joint.speed);
  }

  void see(const Command& command, const Passed& passed, Time now) {
    EXPECT_LE(std::chrono::abs(now - command.stamp), std::chrono::milliseconds(200));
    EXPECT_TRUE(obeyed_.insert({command.writer, command.sequence, command.stamp}).second)
        << "obeyed twice";
    if (last_ && last_->writer != command.writer) {
      EXPECT_GT(now - then_, std::chrono::milliseconds(300)) << "two lead";
      ++leads_;
    }
    const Place& place = passed.place;
    EXPECT_TRUE(place.dof.allFinite() && is_finite(place.X_WB));
    EXPECT_LE((place.dof - limits_.upper).maxCoeff(), 0);
    EXPECT_GE((place.dof - limits_.lower).minCoeff(), 0);
    see_effort(command, passed);
    const Vector3d& p = place.X_WB.translation();
    EXPECT_TRUE((p.array() >= limits_.box_lower.array() - 1e-9).all() &&
                (p.array() <= limits_.box_upper.array() + 1e-9).all());
    const Place& before = place_ ? *place_ : place;
    const double t = to_seconds(now - start);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      joints_[i].go(std::abs(place.dof[k] - before.dof[k]), t);
    }
    base_.go((p - before.X_WB.translation()).norm(), t);
    turn_.go(
        Eigen::AngleAxisd(Eigen::Matrix3d(before.X_WB.linear().transpose() * place.X_WB.linear()))
            .angle(),
        t);
    place_ = place;
    last_ = command;
    then_ = now;
    ++passed_;
  }
  /// Bounded by the limits whatever was asked for, counted where it is cut, and else as it came.
  void see_effort(const Command& command, const Passed& passed) const {
    const Eigen::VectorXd &effort = passed.place.effort, &asked = command.place.effort;
    ASSERT_EQ(effort.size(), limits_.effort.size());
    EXPECT_TRUE((effort.array() >= 0).all() && (effort.array() <= limits_.effort.array()).all());
    if (asked.size() == 0) {
      EXPECT_EQ(effort, limits_.effort);
      EXPECT_FALSE(passed.has(Cut::effort)) << "it asked for nothing";
      return;
    }
    ASSERT_EQ(asked.size(), effort.size());
    EXPECT_TRUE((effort.array() <= asked.array()).all());
    EXPECT_EQ(passed.has(Cut::effort), effort != asked);
  }

  const std::optional<Place>& place() const { return place_; }
  int passed() const { return passed_; }
  int leads() const { return leads_; }

 private:
  Limits limits_;
  std::vector<Way> joints_;
  Way base_, turn_;
  std::set<std::tuple<WriterId, std::uint64_t, Time>> obeyed_;
  std::optional<Place> place_;
  std::optional<Command> last_;
  Time then_{};
  int passed_ = 0, leads_ = 0;
};

class RandomStreams : public testing::TestWithParam<std::string> {};

TEST_P(RandomStreams, NeverPassTheGateBeyondItsRules) {
  const model::HandModel& hand = test::hand(GetParam());
  const auto hands = test::hand_names().size();
  const std::size_t all = std::getenv("PREHEND_LONG") ? 10'000 : 300;
  int passed = 0, leads = 0;
  for (std::uint64_t seed = 0; seed < (all + hands - 1) / hands; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Limits limits = random_limits(random, hand);
    Watch watch(limits);
    auto gate = CommandGate::create(hand, {.hand = "hand"}, limits, [&] { return watch.place(); });
    ASSERT_TRUE(gate);
    for (const Sent& sent : wild(random, hand))
      if (const auto through = gate->admit(sent.command, sent.arrives))
        watch.see(sent.command, *through, sent.arrives);
    passed += watch.passed();
    leads += watch.leads();
    if (HasFailure()) return;
  }
  EXPECT_GT(passed, 1000) << "what refuses everything keeps all limits";
  EXPECT_GT(leads, 0);
}

// As mapping's own limits have it: joints as fast as they can, the base at 1 m/s and 3 rad/s, one
// command at most as far as in 100 ms; postures late by up to 150 ms, commands to stay between.
TEST_P(RandomStreams, OfMappingPassUnchanged) {
  const model::HandModel& hand = test::hand(GetParam());
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    auto gate = made(hand, [&] { return std::optional<Place>(); });
    Place place = open_at(hand, {0, 0, 0.5});
    Time answered = start, moved = start, now = start;
    std::uint64_t sequence = 0;
    int ms = 0;
    for (int i = 0; i < 500; ++i) {
      ms += 5 + static_cast<int>(random.index(30));
      if (random.uniform() < 0.02) ms += 400;
      const bool stays = random.uniform() < 0.1;
      now = std::max(now, at(ms));
      const Time stamp = stays ? now : now - seconds(random.uniform(0, 0.15));
      const double t = stays ? 0 : std::clamp(to_seconds(stamp - moved), 0.0, 0.1);
      moved = std::max(moved, stamp);
      for (Eigen::Index k = 0; k < place.dof.size(); ++k)
        place.dof[k] +=
            random.uniform(-1, 1) * t * hand.dofs()[static_cast<std::size_t>(k)].max_velocity;
      place.dof = hand.clamp(place.dof);
      const Vector3d goal = random.normal3(0.5);
      place.X_WB = limit_step(
          place.X_WB,
          make_pose(goal, Eigen::AngleAxisd(random.normal(), Vector3d::UnitY()).toRotationMatrix()),
          1.0 * t, 3.0 * t);
      place.effort = random.uniform() < 0.5
                         ? Eigen::VectorXd()
                         : Eigen::VectorXd(random.uniform() * model::max_effort(hand));
      const Command command{writer(1), ++sequence, stamp, "hand", hand.name(), place};
      const auto passed = gate.admit(command, now);
      ASSERT_TRUE(passed) << to_string(passed.error()) << ", seed " << seed << ", " << i;
      EXPECT_EQ(passed->place.dof, place.dof);
      EXPECT_EQ(passed->place.effort,
                place.effort.size() > 0 ? place.effort : model::max_effort(hand));
      EXPECT_EQ(passed->place.X_WB.matrix(), place.X_WB.matrix());
      for (std::size_t cut = 0; cut < cuts; ++cut)
        EXPECT_FALSE(passed->cut[cut]) << to_string(static_cast<Cut>(cut)) << ", seed " << seed;
      answered = now;
    }
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(AllHands, RandomStreams, testing::ValuesIn(test::hand_names()),
                         [](const auto& hand) { return hand.param; });

}  // namespace
}  // namespace prehend::gate
