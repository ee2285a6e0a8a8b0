// Glove frame read until the world has accepted the command, over two DDS hops and three processes,
// against a floor: raw Fast DDS processes that do nothing but pass messages of the same types, over
// the same two hops, with the same QoS, paced at the same rate, in the same run. Both run side by
// side in slices, so that a machine that changes its speed changes both.
//
//   benchmark_latency [--json] [--seconds S] [--network laptop|lan|server]      at 30 and at 500 Hz
//
// Floor and lab use the same network; for `server` one is started for the run.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <prehend/base/paths.hpp>
#include <prehend/dds/participant.hpp>
#include <prehend/service/process.hpp>
#include <prehend/service/status.hpp>
#include <random>
#include <thread>

namespace prehend {
namespace {

using namespace std::chrono_literals;
namespace fdds = eprosima::fastdds::dds;

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

struct Place {
  int domain;
  std::string rig;
  std::string network = "laptop";
};

/// Where the discovery server of the run listens, by its domain: other runs have other numbers.
std::string server_of(const Place& place) {
  return "127.0.0.1:" + std::to_string(21000 + place.domain);
}

dds::Network network_of(const Place& place) {
  dds::Network network{.profile = place.network};
  if (place.network == "server") network.servers = {server_of(place)};
  return network;
}

dds::Participant join(const Place& place, const char* name) {
  auto made = dds::Participant::create(
      {.name = name, .domain = place.domain, .rig = place.rig, .network = network_of(place)});
  if (!made) {
    std::cerr << made.error().message() << "\n";
    std::exit(3);
  }
  return std::move(*made);
}

/// Calls `handle` in the thread that received the sample: nothing between wire and code.
template <class T>
class Relay : public fdds::DataReaderListener {
 public:
  explicit Relay(std::function<void(const T&)> handle) : handle_(std::move(handle)) {}
  void on_data_available(fdds::DataReader* reader) override {
    T sample;
    fdds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) handle_(sample);
  }

 private:
  std::function<void(const T&)> handle_;
};

/// First of the floor's processes: a posture at the given rate, stamped when it is made.
int floor_source(const Place& place, double rate) {
  auto participant = join(place, "floor-source");
  auto writer = *participant.writer(dds::hand_posture);
  v1::HandPosture posture;
  posture.glove("glove");
  auto next = std::chrono::steady_clock::now();
  while (getppid() != 1) {
    next += std::chrono::nanoseconds(static_cast<long>(1e9 / rate));
    std::this_thread::sleep_until(next);
    posture.stamp_ns(to_ns(now()));
    posture.origin_ns(posture.stamp_ns());
    writer.write(posture);
  }
  return 0;
}

/// Second: a command for every posture.
int floor_relay(const Place& place) {
  auto participant = join(place, "floor-relay");
  auto writer = *participant.writer(dds::robot_command);
  auto reader = *participant.reader(dds::hand_posture);
  v1::HandCommand command;
  command.hand("hand");
  command.dof(std::vector<double>(4));
  Relay<v1::HandPosture> relay([&](const v1::HandPosture& posture) {
    command.stamp_ns(posture.stamp_ns());
    command.origin_ns(posture.origin_ns());
    writer.write(command);
  });
  reader.raw().set_listener(&relay);
  while (getppid() != 1) std::this_thread::sleep_for(100ms);
  return 0;
}

struct Figures {
  double p50 = 0, p99 = 0;
  std::size_t count = 0;
};

/// The floor's last process is this one: latencies of `wanted` commands.
Figures measure_floor(double rate, std::size_t wanted, const std::string& self, Place place) {
  place.rig = fmt::format("floor-{}-{}", getpid(), rate);
  const auto spawn = [&](const char* role) {
    auto made =
        service::Process::start({.command = {self, role, std::to_string(place.domain), place.rig,
                                             std::to_string(rate), place.network}});
    if (!made) {
      std::cerr << made.error().message() << "\n";
      std::exit(3);
    }
    return std::move(*made);
  };
  auto participant = join(place, "floor-sink");
  auto reader = *participant.reader(dds::robot_command);
  std::mutex mutex;
  service::LatencyWindow window;
  std::atomic<std::size_t> seen = 0;
  const std::size_t warm_up = static_cast<std::size_t>(rate);
  Relay<v1::HandCommand> relay([&](const v1::HandCommand& command) {
    const Duration latency = now() - from_ns(command.origin_ns());
    const std::scoped_lock lock(mutex);
    if (++seen > warm_up) window.add(latency);
  });
  reader.raw().set_listener(&relay);
  auto second = spawn("--floor-relay");
  auto first = spawn("--floor-source");
  while (seen < warm_up + wanted) std::this_thread::sleep_for(20ms);
  reader.raw().set_listener(nullptr);
  first.stop(1s);
  second.stop(1s);
  return {window.quantile_us(0.5), window.quantile_us(0.99), window.count()};
}

/// The real chain: the world's own measure, from its status.
Figures measure_lab(double rate, std::size_t wanted, Place place) {
  const std::string rig = fmt::format("lab-{}-{}", getpid(), rate);
  place.rig = rig;
  const auto bin = program_directory();
  const auto spawn = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> command{(bin / ("prehend-" + name)).string(),
                                     "--set",
                                     "lab.rig=" + rig,
                                     "--set",
                                     "lab.domain=" + std::to_string(place.domain),
                                     "--set",
                                     "lab.network=" + place.network,
                                     "--set",
                                     "lab.server=[\"" + server_of(place) + "\"]"};
    for (std::string& argument : more) {
      command.push_back("--set");
      command.push_back(std::move(argument));
    }
    auto made = service::Process::start(
        {.command = command, .log = std::filesystem::temp_directory_path() / (rig + name)});
    if (!made) {
      std::cerr << made.error().message() << "\n";
      std::exit(3);
    }
    return std::move(*made);
  };
  auto participant = join(place, "watcher");
  auto statuses = *participant.reader(dds::service_status);
  auto simulation = spawn("simulation", {});
  auto mapping = spawn("mapping", {});
  auto glove = spawn("glove", {fmt::format("glove.rate={}", rate)});
  Figures figures;
  std::uint64_t accepted = 0;
  // A full window that was begun after the start: the world keeps the last 1024.
  const std::uint64_t needed =
      static_cast<std::uint64_t>(rate) + std::max<std::uint64_t>(wanted, 0);
  while (accepted < needed) {
    statuses.raw().wait_for_unread_message({5, 0});
    for (const auto& sample : statuses.take()) {
      if (sample.info.gone || std::string_view(sample.data.name().c_str()) != "simulation")
        continue;
      for (const auto& stage : sample.data.latency())
        if (std::string_view(stage.stage().c_str()) == "glove to accepted")
          figures = {stage.p50_us(), stage.p99_us(), static_cast<std::size_t>(stage.count())};
      for (const auto& r : sample.data.rates())
        if (std::string_view(r.name().c_str()) == "commands") accepted = r.total();
    }
    for (auto* process : {&simulation, &mapping, &glove})
      if (process->exit()) {
        std::cerr << "a service ended: " << service::last_lines(process->log(), 5) << "\n";
        std::exit(3);
      }
  }
  return figures;
}

int run(bool json, double seconds, const std::string& network, const std::string& self) {
  const Place place{static_cast<int>(std::random_device{}() % 200), "", network};
  std::optional<service::Process> server;
  if (network == "server") {
    auto made =
        service::Process::start({.command = {(program_directory() / "prehend").string(),
                                             "discovery-server", "--listen", server_of(place)},
                                 .log = "/dev/null"});
    if (!made) {
      std::cerr << made.error().message() << "\n";
      return 3;
    }
    server.emplace(std::move(*made));
    std::this_thread::sleep_for(2s);  // it listens 1.2 s after its start
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const double rate : {30.0, 500.0}) {
    const auto wanted = static_cast<std::size_t>(std::min(1024.0, rate * seconds));
    const Figures before = measure_floor(rate, wanted, self, place);
    const Figures lab = measure_lab(rate, wanted, place);
    const Figures after = measure_floor(rate, wanted, self, place);
    const double floor = 0.5 * (before.p50 + after.p50);
    rows.push_back({{"rate_hz", rate},
                    {"floor_us", {{"p50", floor}, {"p99", 0.5 * (before.p99 + after.p99)}}},
                    {"lab_us", {{"p50", lab.p50}, {"p99", lab.p99}}},
                    {"ratio_of_medians", lab.p50 / floor},
                    {"samples", lab.count}});
    if (!json)
      fmt::print(
          "{:5.0f} Hz: floor p50 {:.0f} p99 {:.0f} us, lab p50 {:.0f} p99 {:.0f} us, "
          "ratio of medians {:.2f}\n",
          rate, floor, 0.5 * (before.p99 + after.p99), lab.p50, lab.p99, lab.p50 / floor);
  }
  if (json) std::cout << rows.dump() << "\n";
  return 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (argc == 6 && std::string_view(argv[1]).starts_with("--floor-")) {
    const Place place{std::atoi(argv[2]), argv[3], argv[5]};
    return std::string_view(argv[1]) == "--floor-source" ? floor_source(place, std::atof(argv[4]))
                                                         : floor_relay(place);
  }
  bool json = false;
  double seconds = 8;
  std::string network = "laptop";
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--json") json = true;
    if (std::string_view(argv[i]) == "--seconds" && i + 1 < argc) seconds = std::atof(argv[++i]);
    if (std::string_view(argv[i]) == "--network" && i + 1 < argc) network = argv[++i];
  }
  return run(json, seconds, network, std::filesystem::read_symlink("/proc/self/exe").string());
}
