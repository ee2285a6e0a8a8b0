// Lockstep: a shell that is led by lab/clock gives the same answers however messages arrive. The
// service here sums what it reads on two topics in order; sums of this kind depend on the order.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "common/service/shell.hpp"
#include "common/stage/conductor.hpp"
#include "tests/support/domains/domain_lease.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::service {
namespace {

using namespace std::chrono_literals;

struct Played {
  std::vector<double> answers;
  std::vector<std::int64_t> ticks;
};

/// Plays `frames` postures and detections to an order-sensitive service; pauses vary with the seed.
Played play(unsigned seed, int domain, const std::string& rig) {
  Played run;
  const std::string rig_setting = "lab.rig=" + rig;
  const std::string config = test::in_sources("deploy/lab.toml");
  const std::string domain_setting = "lab.domain=" + std::to_string(domain);
  const char* arguments[] = {"test",  "--config",          config.c_str(), "--lockstep",
                             "--set", rig_setting.c_str(), "--set",        domain_setting.c_str()};
  auto created = Shell::create(8, const_cast<char**>(arguments), {"summing", "sums"});
  EXPECT_TRUE(created);
  if (!created) return run;
  const std::unique_ptr<Shell> shell = std::move(*created);
  double state = 1;
  auto output = shell->publish(dds::robot_state);
  shell->subscribe(dds::hand_posture, [&](const v1::HandPosture& posture, const dds::SampleInfo&) {
    state = 0.9 * state + posture.quality();
  });
  shell->subscribe(dds::object_detection,
                   [&](const v1::ObjectDetection& detection, const dds::SampleInfo& info) {
                     state = info.gone ? -state : 1.1 * state - detection.probability();
                   });
  shell->on_tick(10ms, [&](Time now) {
    run.ticks.push_back(to_ns(now));
    v1::HandState message;
    message.hand("hand");
    message.stamp_ns(to_ns(now));
    message.dof({state});
    output.publish(message);
  });
  std::thread service([&] { EXPECT_EQ(shell->run(), exit_done); });

  auto participant =
      dds::Participant::create({.name = "test", .domain = domain, .rig = rig, .lockstep = true});
  EXPECT_TRUE(participant);
  auto postures = participant->writer(dds::hand_posture);
  auto detections = participant->writer(dds::object_detection);
  auto states = participant->reader(dds::robot_state);
  auto conductor = stage::Conductor::create(*participant, {"summing"});
  std::mt19937 random(seed);
  std::size_t steps = 0;  // with a tick and an answer each
  for (int i = 1; i <= 60; ++i) {
    const Time now = from_ns(i * 10'000'000);
    const auto post = [&] {
      v1::HandPosture posture;
      posture.glove("glove");
      posture.stamp_ns(to_ns(now) - 3);
      posture.quality(0.01 * i);
      EXPECT_TRUE(postures->write(posture));
      conductor->published("hand/posture");
    };
    const auto detect = [&] {
      v1::ObjectDetection detection;
      detection.track(1);
      detection.stamp_ns(to_ns(now) - 5);  // older, though it may arrive later
      detection.probability(0.02 * i);
      EXPECT_TRUE(detections->write(detection));
      conductor->published("object/detection");
      if (i % 20 == 0) {
        EXPECT_TRUE(detections->dispose(detection));
        conductor->published("object/detection");
      }
    };
    // What differs between runs: the order of writing and how long it takes.
    if (random() % 2)
      post(), detect();
    else
      detect(), post();
    if (random() % 4 == 0) std::this_thread::sleep_for(std::chrono::microseconds(random() % 3000));
    const auto stepped = conductor->step(now, 5s);
    EXPECT_TRUE(stepped) << stepped.error().message();
    if (!stepped) break;
    ++steps;
  }
  while (run.answers.size() < steps) {
    if (!states->raw().wait_for_unread_message({5, 0})) break;
    for (const auto& sample : states->take())
      if (!sample.info.gone) run.answers.push_back(sample.data.dof()[0]);
  }
  shell->stop();
  service.join();
  return run;
}

TEST(Lockstep, AnswersDoNotDependOnArrival) {
  const test::DomainLease lease;
  const int domain = lease.domain();
  const std::string rig = "lockstep-" + std::to_string(getpid());
  const Played first = play(1, domain, rig + "a");
  ASSERT_EQ(first.answers.size(), 60u);
  for (unsigned seed = 2; seed < 6; ++seed) {
    const Played again = play(seed, domain, rig + std::to_string(seed));
    EXPECT_EQ(again.ticks, first.ticks);
    EXPECT_EQ(again.answers, first.answers) << "bit for bit";
  }
}

/// A shell in lockstep, which runs in a thread until it goes.
class Running {
 public:
  Running(const std::string& name, int domain, const std::string& rig) {
    auto created =
        Shell::create({"--config", test::in_sources("deploy/lab.toml"), "--lockstep", "--set",
                       "lab.rig=" + rig, "--set", "lab.domain=" + std::to_string(domain)},
                      {name, "of a test"});
    if (created) shell_ = std::move(*created);
  }
  ~Running() {
    if (!thread_.joinable()) return;
    shell_->stop();
    thread_.join();
  }
  Shell& operator*() { return *shell_; }
  void run() {
    thread_ = std::thread([this] { EXPECT_EQ(shell_->run(), exit_done); });
  }

 private:
  std::unique_ptr<Shell> shell_;
  std::thread thread_;
};

/// Two that publish on one topic, a glove each, at equal stamps, and one that sums what they say.
/// Which of them joins first, and how long each takes, varies with the seed.
std::vector<double> sums_of_two(unsigned seed, int domain, const std::string& rig) {
  std::vector<double> sums;
  std::mt19937 random(seed);
  Running summing("summing", domain, rig);
  double state = 1;
  (*summing).subscribe(dds::hand_posture,
                       [&](const v1::HandPosture& posture, const dds::SampleInfo&) {
                         state = 0.9 * state + posture.quality();
                       });
  (*summing).on_tick(10ms, [&](Time) { sums.push_back(state); });
  std::vector<std::string> gloves{"left", "right"};
  if (random() % 2) std::ranges::reverse(gloves);
  std::vector<std::unique_ptr<Running>> talking;
  for (const std::string& glove : gloves) {
    talking.push_back(std::make_unique<Running>("talking", domain, rig));
    Shell& shell = **talking.back();
    shell.on_tick(10ms, [glove, wait = std::mt19937(random()),
                         publish = shell.publish(dds::hand_posture).publish](Time now) mutable {
      v1::HandPosture posture;
      posture.glove(glove.c_str());
      posture.stamp_ns(to_ns(now));
      posture.quality(glove == "left" ? 0.1 : 0.2);
      std::this_thread::sleep_for(std::chrono::microseconds(wait() % 2000));
      publish(posture);
      publish(posture);
    });
  }
  summing.run();
  for (auto& one : talking) one->run();
  auto participant =
      dds::Participant::create({.name = "test", .domain = domain, .rig = rig, .lockstep = true});
  auto conductor = stage::Conductor::create(*participant, {"talking", "summing", "talking"});
  for (int i = 1; i <= 60; ++i) {
    const auto stepped = conductor->step(from_ns(i * 10'000'000), 5s);
    EXPECT_TRUE(stepped) << stepped.error().message();
    if (!stepped) break;
  }
  EXPECT_EQ(conductor->totals().at("hand/posture"), 240U);
  return sums;
}

// Guards a clock that counted all writers of a topic together: of two, the one that was quick could
// stand for the one that was late.
TEST(Lockstep, TwoWritersOfATopicAreInOrder) {
  const test::DomainLease lease;
  const std::string rig = "two-" + std::to_string(getpid());
  const auto first = sums_of_two(1, lease.domain(), rig + "a");
  ASSERT_EQ(first.size(), 60U);
  for (unsigned seed = 2; seed < 6; ++seed)
    EXPECT_EQ(sums_of_two(seed, lease.domain(), rig + std::to_string(seed)), first);
}

TEST(Lockstep, AMissingServiceIsNamed) {
  const test::DomainLease lease;
  auto participant = dds::Participant::create({.name = "test",
                                               .domain = lease.domain(),
                                               .rig = "empty-" + std::to_string(getpid()),
                                               .lockstep = true});
  auto conductor = stage::Conductor::create(*participant, {"nobody"});
  const auto stepped = conductor->step(from_ns(1), 50ms);
  ASSERT_FALSE(stepped);
  EXPECT_NE(stepped.error().message().find("nobody"), std::string::npos);
}

}  // namespace
}  // namespace prehend::service
