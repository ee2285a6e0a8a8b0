// A rig of processes whose clocks differ by hours, over a network that delays and loses beacons:
// after two beacons of each side everybody knows everybody's clock to within its uncertainty,
// stamps come out in the reader's own time, and a process whose clock agrees is left alone.
#include "common/clock/peers.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>
#include <vector>

namespace prehend::clock {
namespace {

using std::chrono::milliseconds;

Participant participant(std::uint8_t process, std::uint8_t number = 1) {
  Participant id{};
  id[4] = process;
  id[8] = number;
  return id;
}

struct Node {
  std::string name;
  Duration ahead;  // of true time
  Participant id;
  Peers peers;
  Node(const std::string& n, Duration a, std::uint8_t p)
      : name(n), ahead(a), id(participant(p)), peers(n, "host") {}
  Time clock(Time now) const { return now + ahead; }
};

class Rig : public testing::Test {
 protected:
  void add(const std::string& name, Duration ahead) {
    nodes.push_back(
        std::make_unique<Node>(name, ahead, static_cast<std::uint8_t>(nodes.size() + 1)));
  }
  /// A beacon of one node reaches the others, each after a delay of its own; who must answer does.
  void send(Node& from, int depth = 0) {
    const v1::ClockBeacon beacon = from.peers.beacon(from.clock(now), {});
    for (auto& to : nodes) {
      if (std::bernoulli_distribution(loss)(random)) continue;
      now += std::chrono::microseconds(std::uniform_int_distribution(50, 500)(random));
      const auto heard = to->peers.hear(beacon, from.id, to->clock(now));
      if (heard.step) steps.push_back(*heard.step);
      if (heard.answer && depth < 3) send(*to, depth + 1);
    }
  }
  void round() {
    for (auto& node : nodes) send(*node);
    now += seconds(1);
  }
  void expect_known() {
    for (auto& one : nodes)
      for (auto& other : nodes) {
        if (one == other) continue;
        const auto offset = one->peers.offset(other->name, one->clock(now));
        ASSERT_TRUE(offset) << one->name << " of " << other->name;
        EXPECT_LE(std::chrono::abs(offset->offset - (other->ahead - one->ahead)),
                  offset->uncertainty);
        EXPECT_LT(offset->uncertainty, milliseconds(5));
      }
  }

  std::mt19937 random{7};
  double loss = 0;
  Time now = from_ns(1'700'000'000'000'000'000);
  std::vector<std::unique_ptr<Node>> nodes;
  std::vector<Duration> steps;
};

TEST_F(Rig, OneBeaconIsEnoughToBeAnsweredAndKnown) {
  add("glove", seconds(3600));
  add("mapping", Duration::zero());
  add("simulation", seconds(-7.5));
  for (auto& node : nodes) send(*node);
  expect_known();
}

TEST_F(Rig, LostBeaconsOnlyTakeLonger) {
  loss = 0.3;
  add("glove", seconds(3600));
  add("mapping", Duration::zero());
  for (int i = 0; i < 10; ++i) round();
  expect_known();
}

TEST_F(Rig, StampsComeOutInTheReadersTime) {
  add("glove", seconds(3600));
  add("mapping", Duration::zero());
  round();
  const Time reader = nodes[1]->clock(now);
  const Time stamp = nodes[0]->clock(now);  // made now, by the glove's clock
  const Time moved = stamp - nodes[1]->peers.ahead(nodes[0]->id, reader);
  EXPECT_LT(std::chrono::abs(moved - reader), milliseconds(2));
  // A second participant of the same process, as the replayer has, is of the same clock.
  EXPECT_EQ(nodes[1]->peers.ahead(participant(1, 9), reader),
            nodes[1]->peers.ahead(nodes[0]->id, reader));
  EXPECT_EQ(nodes[1]->peers.ahead(participant(77), reader), Duration::zero());
}

TEST_F(Rig, AgreeingClocksAreLeftAlone) {
  add("glove", Duration::zero());
  add("mapping", std::chrono::microseconds(20));
  for (int i = 0; i < 20; ++i) {
    round();
    EXPECT_EQ(nodes[1]->peers.ahead(nodes[0]->id, nodes[1]->clock(now)), Duration::zero());
  }
}

TEST_F(Rig, AClockThatIsSetIsToldOnceAndFollowed) {
  add("glove", Duration::zero());
  add("mapping", Duration::zero());
  for (int i = 0; i < 5; ++i) round();
  ASSERT_TRUE(steps.empty());
  // Started anew by another clock, as a process is after somebody set the system's.
  nodes[0]->ahead = seconds(3600);
  for (int i = 0; i < 3; ++i) round();
  ASSERT_FALSE(steps.empty());
  EXPECT_NEAR(std::abs(to_seconds(steps.front())), 3600, 2);
  expect_known();
}

TEST_F(Rig, TheSystemsClockIsFollowedForWhatDdsNotes) {
  add("glove", Duration::zero());
  add("mapping", Duration::zero());
  round();
  const v1::ClockBeacon beacon = nodes[0]->peers.beacon(nodes[0]->clock(now), seconds(3600));
  const Time reader = nodes[1]->clock(now);
  nodes[1]->peers.hear(beacon, nodes[0]->id, reader);
  EXPECT_EQ(nodes[1]->peers.ahead(nodes[0]->id, reader), Duration::zero());
  EXPECT_EQ(nodes[1]->peers.system_ahead(nodes[0]->id, reader), seconds(3600));
}

// A beacon says itself whose it is: one that takes another's name must not move that one's stamps,
// nor make others wrong about our clock.
TEST_F(Rig, WhoClaimsAnothersNameShiftsNobodysStamps) {
  add("glove", Duration::zero());
  add("mapping", Duration::zero());
  for (int i = 0; i < 3; ++i) round();
  Peers liar("glove", "host");
  const Participant its = participant(66);
  for (int i = 0; i < 10; ++i) {
    const Time fast = now + seconds(3600);
    liar.hear(nodes[1]->peers.beacon(nodes[1]->clock(now), {}), nodes[1]->id, fast);
    for (auto& node : nodes) node->peers.hear(liar.beacon(fast, {}), its, node->clock(now));
    round();
  }
  const Time reader = nodes[1]->clock(now);
  EXPECT_EQ(nodes[1]->peers.ahead(nodes[0]->id, reader), Duration::zero());
  EXPECT_NEAR(to_seconds(nodes[1]->peers.ahead(its, reader)), 3600, 1)
      << "its own clock is its own";
  EXPECT_EQ(nodes[0]->peers.ahead(nodes[1]->id, nodes[0]->clock(now)), Duration::zero());
  EXPECT_TRUE(steps.empty()) << "no clock was set";
}

TEST_F(Rig, NobodyIsRememberedForEverAndNobodyFillsTheMemory) {
  add("mapping", Duration::zero());
  Peers& peers = nodes[0]->peers;
  for (int i = 0; i < 5000; ++i) {
    v1::ClockBeacon beacon;
    beacon.service("stranger-" + std::to_string(i));
    beacon.stamp_ns(to_ns(now));
    peers.hear(beacon, participant(2), now);
  }
  EXPECT_LE(peers.beacon(now, {}).peers().size(), 64u);
  EXPECT_TRUE(peers.beacon(now + seconds(60), {}).peers().empty());
}

}  // namespace
}  // namespace prehend::clock
