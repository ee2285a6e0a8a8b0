// Lockstep: a shell that is led by lab/clock gives the same answers however messages arrive. The
// service here sums what it reads on two topics in order; sums of this kind depend on the order.
#include <gtest/gtest.h>
#include <unistd.h>

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
