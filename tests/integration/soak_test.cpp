// A lab whose glove gives 500 frames a second runs on and on: no sample of a reliable topic is lost
// and no process grows. Lost is what a reader that keeps everything misses in the numbers of a
// topic's writer. Memory is that of the processes' own status, the median of ten seconds each at
// the beginning, when every kind of buffer has been used once, and at the end. 20 minutes under
// PREHEND_LONG, else so short that only a gross leak would show.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "common/dds/raw.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

class Soak : public Rig {
 protected:
  struct Watched {
    dds::TopicInfo topic;
    std::unique_ptr<dds::RawReader> reader;
  };
  template <class P>
  void watch(const dds::Topic<P>& topic) {
    auto made =
        dds::RawReader::create(*participant_, dds::raw_topic(topic), [](dds::RawSample&&) {});
    ASSERT_TRUE(made) << made.error().message();
    watched_.push_back({topic, std::move(*made)});
  }
  /// Memory of each service over some seconds, as it says it itself.
  std::map<std::string, double> memory(double length_s) {
    std::map<std::string, std::vector<double>> heard;
    eventually(length_s, [&] {
      for (const auto& sample : statuses_.take())
        if (!sample.info.gone)
          heard[sample.data.name().to_string()].push_back(
              static_cast<double>(sample.data.resident()));
      return false;
    });
    std::map<std::string, double> medians;
    for (const auto& [name, values] : heard) medians[name] = median(values);
    return medians;
  }
  std::vector<Watched> watched_;
  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
};

TEST_F(Soak, NothingIsLostAndNothingGrows) {
  const bool all = std::getenv("PREHEND_LONG") != nullptr;
  // Bytes. Half a minute after its start recognition still takes its last buffers, 0.9 MB.
  const double max_growth = all ? 1e6 : 3e6;
  const double warm_up = all ? 60 : 3, length = all ? 1200 : 10, window = all ? 10 : 4;
  watch(dds::glove_frame);
  watch(dds::hand_posture);
  watch(dds::object_detection);
  watch(dds::robot_command);
  watch(dds::robot_state);
  watch(dds::scene_state);
  watch(dds::grasp_report);
  watch(dds::lab_beacon);
  const Strings sets{"lab.scene=" + scene(1), "glove.device=synthetic", "glove.rate=500"};
  std::map<std::string, stage::Process> processes;
  for (const char* name : {"recognition", "mapping", "simulation", "glove"})
    processes.emplace(name, start(name, sets));
  ASSERT_TRUE(eventually(40, [&] {
    return std::all_of(watched_.begin(), watched_.end(), [](const Watched& one) {
      return one.reader->received() > 0 || one.topic.qos.writer_depth == 0;
    });
  })) << "the lab does not start";
  // The first grasps take what a judge needs.
  const auto reports = [&] {
    return std::find_if(watched_.begin(), watched_.end(),
                        [](const Watched& one) { return one.topic.name == dds::grasp_report.name; })
        ->reader->received();
  };
  ASSERT_TRUE(eventually(90, [&] { return reports() >= 2; })) << "nothing is grasped";
  memory(warm_up);
  const auto before = memory(window);
  memory(length - window);
  const auto after = memory(window);

  fmt::print("\n| topic, {:.0f} s | samples | lost |\n|---|---|---|\n", warm_up + length + window);
  for (const Watched& one : watched_) {
    fmt::print("| {}{} | {} | {} |\n", one.topic.name,
               one.topic.qos.reliable ? "" : " (best effort)", one.reader->received(),
               one.reader->lost());
    if (one.topic.qos.reliable) {
      EXPECT_EQ(one.reader->lost(), 0u) << one.topic.name;
    }
  }
  fmt::print("\n| process | MB | {:.0f} s later | growth |\n|---|---|---|---|\n", length);
  for (auto& [name, process] : processes) {
    EXPECT_FALSE(process.exit()) << name << " ended";
    ASSERT_TRUE(before.contains(name) && after.contains(name)) << name << " says nothing";
    const double growth = after.at(name) - before.at(name);
    fmt::print("| {} | {:.2f} | {:.2f} | {:+.2f} |\n", name, before.at(name) / 1e6,
               after.at(name) / 1e6, growth / 1e6);
    EXPECT_LT(growth, max_growth) << "bytes, " << name;
  }
}

}  // namespace
}  // namespace prehend::integration
