// How exactly a recording is played: prehend-replay, a process of its own, plays 500 messages a
// second. Seen from two places: at the write call (the time right before it against the time at
// which the message is due, told by the player itself) and at a subscriber in this process (the
// time at which the sample was handed to us against the same due time, so with the hop of DDS).
//
// The floor plays the same messages at the same times in the simplest way there is: a process that
// sleeps with sleep_until and writes. Floor, player and floor come one after the other in one run.
//
//   benchmark_replay [--json] [--seconds S]      exit code 1: p99 at the write call is 1 ms or more
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/paths.hpp"
#include "common/base/random.hpp"
#include "common/dds/raw.hpp"
#include "common/stage/process.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "services/recorder/service/tape.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using Json = nlohmann::ordered_json;

constexpr double rate = 500;         // Hz
constexpr double aim_us = 1000;      // p99 at the write call
constexpr double start_delay_s = 2;  // for the endpoints to find each other

struct Place {
  int domain;
  std::string rig;
};

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

template <class T>
T need(Expected<T> made) {
  if (made) return std::move(*made);
  std::cerr << made.error().message() << "\n";
  std::exit(3);
}

dds::Participant join(const Place& place, const char* name) {
  return need(dds::Participant::create({.name = name, .domain = place.domain, .rig = place.rig}));
}

recorder::Tape open(const std::filesystem::path& file) {
  return need(recorder::Tape::open({file}, [](const std::string&) { return true; }));
}

/// Postures of a glove at the rate, each up to a quarter of a period off its beat.
void write_recording(const std::filesystem::path& path, double duration_s) {
  const recorder::Heading heading{{}, "", [](const std::string&) { return std::nullopt; }};
  auto file =
      need(recorder::RecordingFile::create(path, heading, recording::mcap::Compression::zstd));
  const recorder::Source source{dds::raw_topic(dds::hand_posture), "lab"};
  Random random(1);
  v1::HandPosture posture;
  posture.glove("glove");
  posture.joint_angles(std::vector<double>(22, 0.1));
  const Time begin = from_ns(1'700'000'000'000'000'000);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(duration_s * rate); ++i) {
    const double offset = i == 0 ? 0 : 0.25 * (2 * random.uniform() - 1);
    const Time time = begin + seconds((static_cast<double>(i) + offset) / rate);
    posture.sequence_number(i);
    posture.stamp_ns(to_ns(time));
    dds::RawSample sample;
    sample.payload = dds::encode(dds::hand_posture, posture);
    sample.instance[0] = 1;
    sample.writer[0] = 1;
    sample.sequence = i + 1;
    sample.sent = sample.received = time;
    if (!file.write(source, sample, time)) std::exit(3);
  }
  if (!file.close()) std::exit(3);
}

struct Stats {
  double p50 = 0, p99 = 0, max = 0;  // us
};

Stats stats_of(std::vector<double> late_us) {
  std::sort(late_us.begin(), late_us.end());
  const auto quantile = [&](double q) {
    return late_us[static_cast<std::size_t>(q * static_cast<double>(late_us.size() - 1))];
  };
  return {quantile(0.5), quantile(0.99), quantile(1)};
}

Json to_json(const Stats& stats) {
  return {{"p50", stats.p50}, {"p99", stats.p99}, {"max", stats.max}};
}

Stats from_json(const Json& json) {
  return {json["p50"], json["p99"], json["max"]};
}

/// The floor's process: prints how late its calls were.
int floor_player(const Place& place, const std::string& file, std::int64_t start_ns) {
  auto participant = join(place, "floor");
  auto tape = open(file);
  const auto& topic = tape.streams().front()->topic;
  auto writer = need(dds::RawWriter::create(participant, topic));
  std::vector<recorder::Played> all;
  while (auto one = tape.next()) all.push_back(std::move(*one));
  std::vector<double> late_us;
  const auto begin = std::chrono::steady_clock::now() + (from_ns(start_ns) - system_now());
  for (const recorder::Played& one : all) {
    const auto due = begin + (one.log_time - tape.start());
    std::this_thread::sleep_until(due);
    late_us.push_back(1e6 * to_seconds(std::chrono::steady_clock::now() - due));
    writer.write(one.sample, one.sample.sent);
  }
  writer.raw().wait_for_acknowledgments({2, 0});
  std::cout << Json{{"late_us", to_json(stats_of(late_us))}}.dump() << "\n";
  return 0;
}

struct Run {
  Stats writing, arriving;
  std::size_t lost = 0;
};

/// Runs a player to its end and listens.
Run measure(const std::filesystem::path& file, int domain,
            const std::function<std::vector<std::string>(const Place&, Time start)>& command) {
  const Place place{domain, fmt::format("replay-{}-{}", ::getpid(), to_ns(system_now()))};
  auto participant = join(place, "listener");
  auto tape = open(file);
  std::mutex mutex;
  std::vector<std::pair<Time, Time>> heard;  // sent, handed over
  auto reader = need(dds::RawReader::create(participant, tape.streams().front()->topic,
                                            [&](dds::RawSample&& sample) {
                                              const Time now = system_now();
                                              const std::scoped_lock lock(mutex);
                                              heard.emplace_back(sample.sent, now);
                                            }));
  const Time start = system_now() + seconds(start_delay_s);
  const auto output = file.parent_path() / (place.rig + ".out");
  auto process = need(stage::Process::start(
      {.command = command(place, start), .log = file.string() + ".log", .output = output}));
  const auto exit = process.wait(seconds(600));
  if (!exit || exit->code != 0) {
    std::cerr << stage::last_lines(file.string() + ".log", 5) << "\n";
    std::exit(3);
  }
  std::ifstream said(output);
  Run run;
  run.writing = from_json(Json::parse(said)["late_us"]);
  std::size_t count = 0;
  while (tape.next()) ++count;
  const std::scoped_lock lock(mutex);
  std::vector<double> late_us;
  for (const auto& [sent, now] : heard)  // sent is the log time here
    late_us.push_back(1e6 * to_seconds((now - start) - (sent - tape.start())));
  if (heard.empty()) {
    std::cerr << "nothing was heard\n";
    std::exit(3);
  }
  run.lost = count - heard.size();
  run.arriving = stats_of(late_us);
  return run;
}

int run(bool json, double duration_s, const std::string& self) {
  const test::DomainLease lease;
  const int domain = lease.domain();
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("prehend-replay-{}", ::getpid());
  std::filesystem::create_directories(folder);
  const auto file = folder / "postures.mcap";
  write_recording(file, duration_s);
  const auto floor = [&] {
    return measure(file, domain, [&](const Place& place, Time start) {
      return std::vector<std::string>{self,      "--floor",     std::to_string(place.domain),
                                      place.rig, file.string(), std::to_string(to_ns(start))};
    });
  };
  const Run before = floor();
  const Run player = measure(file, domain, [&](const Place& place, Time start) {
    return std::vector<std::string>{
        (program_directory() / "prehend-replay").string(),
        file.string(),
        "--json",
        "--set",
        "lab.rig=" + place.rig,
        "--set",
        fmt::format("lab.domain={}", place.domain),
        "--start-at",
        fmt::format("{:.6f}", 1e-9 * static_cast<double>(to_ns(start)))};
  });
  const Run after = floor();
  std::filesystem::remove_all(folder);

  Json document{{"rate_hz", rate}, {"seconds", duration_s}};
  for (const auto& [name, of] :
       {std::pair("write_call", &Run::writing), std::pair("subscriber", &Run::arriving)}) {
    const Stats &a = before.*of, &b = after.*of, &x = player.*of;
    const Stats mean{0.5 * (a.p50 + b.p50), 0.5 * (a.p99 + b.p99), std::max(a.max, b.max)};
    document[name] = {
        {"floor_us", to_json(mean)}, {"player_us", to_json(x)}, {"ratio_of_p99", x.p99 / mean.p99}};
    if (!json)
      fmt::print(
          "{:11} floor p50 {:.0f} p99 {:.0f} max {:.0f} us, player p50 {:.0f} p99 {:.0f} max "
          "{:.0f} us, ratio of p99 {:.2f}\n",
          name, mean.p50, mean.p99, mean.max, x.p50, x.p99, x.max, x.p99 / mean.p99);
  }
  document["lost"] = player.lost;
  if (json)
    std::cout << document.dump() << "\n";
  else
    fmt::print("{:.0f} s at {:.0f} Hz, {} lost\n", duration_s, rate, player.lost);
  return player.writing.p99 < aim_us ? 0 : 1;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (argc == 6 && std::string_view(argv[1]) == "--floor")
    return floor_player({std::atoi(argv[2]), argv[3]}, argv[4], std::atoll(argv[5]));
  bool json = false;
  double seconds = 20;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--json") json = true;
    if (std::string_view(argv[i]) == "--seconds" && i + 1 < argc) seconds = std::atof(argv[++i]);
  }
  return run(json, seconds, std::filesystem::read_symlink("/proc/self/exe").string());
}
