// Glove frame read until the world has accepted the command, over two DDS hops and three processes,
// against a floor: raw Fast DDS processes that do nothing but pass messages of the same types, over
// the same two hops, with the same QoS, paced at the same rate, in the same run. Both run side by
// side in slices, so that a machine that changes its speed changes both. The floor takes the same
// way, keys and delay included.
//
//   benchmark_latency [--json] [--seconds S] [--case NAME]...     each at 30 and at 500 Hz
//
// Cases:
//   laptop       over loopback
//   containers   each process in a network space of its own on one bridge, as engines make them
//   (root) server       loopback, found through a discovery server that is started for the run
//   secure       as laptop, encrypted with keys that are made for the run
//   far          as containers, secure, and the glove is 20 ms away (root)
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
#include <thread>

#include "common/base/paths.hpp"
#include "common/dds/participant.hpp"
#include "common/service/status.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"
#include "tests/integration/hosts.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using namespace std::chrono_literals;
namespace fdds = eprosima::fastdds::dds;

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// Where a process of the run is and how it reaches the others.
struct Place {
  int domain = 0;
  std::string rig, network = "laptop", server;
  std::filesystem::path keys;  // of all roles; empty: not secured
};

/// role: whose keys it has.
dds::Participant join(const Place& place, const char* name, const char* role) {
  dds::Network network{.profile = place.network, .keys = place.keys};
  if (place.network == "server") network.servers = {place.server};
  auto made = dds::Participant::create(
      {.name = name, .domain = place.domain, .rig = place.rig, .network = network, .role = role});
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
    while (dds::succeeded(reader->take_next_sample(&sample, &info)))
      if (info.valid_data) handle_(sample);
  }

 private:
  std::function<void(const T&)> handle_;
};

/// First of the floor's processes: a posture at the given rate, stamped when it is made.
int floor_source(const Place& place, double rate) {
  auto participant = join(place, "floor-source", "glove");
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
  auto participant = join(place, "floor-relay", "mapping");
  auto writer = *participant.writer(dds::robot_command);
  auto reader = *participant.reader(dds::hand_posture);
  v2::HandCommand command;
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

struct Stats {
  double p50 = 0, p99 = 0;
  std::size_t count = 0;
};

/// A case of the table, while it is measured: its place, and on which host each process runs.
class Case {
 public:
  Case(const std::string& name, const std::filesystem::path& keys)
      : place_{lease_.domain(), "", "laptop", fmt::format("127.0.0.1:{}", lease_.port()), {}} {
    if (name == "server") place_.network = "server";
    if (name == "secure" || name == "far") place_.keys = keys;
    if (name == "containers" || name == "far") {
      if (const auto why = integration::Hosts::unavailable()) throw std::runtime_error(*why);
      place_.network = "lan";
      hosts_.emplace((program_directory() / "prehend-delay-line").string());
      hosts_->add("glove", {.delay_ms = name == "far" ? 20.0 : 0.0});
      hosts_->add("mapping");
      hosts_->add("simulation");
      hosts_->enter("simulation");
    }
    if (name != "server") return;
    server_.emplace(start("", {(program_directory() / "prehend").string(), "discovery-server",
                               "--listen", place_.server}));
    std::this_thread::sleep_for(2s);  // it listens 1.2 s after its start
  }
  /// `rig` alone: what went before is still told of.
  Place place(const std::string& rig) const {
    Place own = place_;
    own.rig = rig;
    return own;
  }
  stage::Process start(const std::string& host, std::vector<std::string> command,
                       const std::filesystem::path& log = "/dev/null") const {
    if (hosts_ && !host.empty()) command = hosts_->on(host, std::move(command));
    auto made = stage::Process::start({.command = std::move(command), .log = log});
    if (!made) {
      std::cerr << made.error().message() << "\n";
      std::exit(3);
    }
    return std::move(*made);
  }

 private:
  const test::DomainLease lease_;
  Place place_;
  std::optional<integration::Hosts> hosts_;
  std::optional<stage::Process> server_;
};

/// The floor's last process is this one: latencies of `wanted` commands.
Stats measure_floor(double rate, std::size_t wanted, const std::string& self, const Case& at) {
  const Place place = at.place(fmt::format("floor-{}-{}", getpid(), rate));
  const auto spawn = [&](const char* role, const char* host) {
    return at.start(host, {self, role, std::to_string(place.domain), place.rig,
                           std::to_string(rate), place.network, place.server, place.keys.string()});
  };
  auto participant = join(place, "floor-sink", "viewer");
  auto reader = *participant.reader(dds::robot_command);
  std::mutex mutex;
  service::LatencyWindow window;
  std::atomic<std::size_t> seen = 0;
  const std::size_t warm_up = static_cast<std::size_t>(rate);
  Relay<v2::HandCommand> relay([&](const v2::HandCommand& command) {
    const Duration latency = now() - from_ns(command.origin_ns());
    const std::scoped_lock lock(mutex);
    if (++seen > warm_up) window.add(latency);
  });
  reader.raw().set_listener(&relay);
  auto second = spawn("--floor-relay", "mapping");
  auto first = spawn("--floor-source", "glove");
  while (seen < warm_up + wanted) std::this_thread::sleep_for(20ms);
  reader.raw().set_listener(nullptr);
  first.stop(1s);
  second.stop(1s);
  return {window.quantile_us(0.5), window.quantile_us(0.99), window.count()};
}

/// The real chain: the world's own measure, from its status.
Stats measure_lab(double rate, std::size_t wanted, const Case& at,
                  const std::filesystem::path& audit) {
  const std::string rig = fmt::format("lab-{}-{}", getpid(), rate);
  const Place place = at.place(rig);
  const auto spawn = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> command{(program_directory() / ("prehend-" + name)).string()};
    more.insert(more.end(),
                {"lab.rig=" + rig, fmt::format("lab.domain={}", place.domain),
                 "lab.network=" + place.network, "lab.server=[\"" + place.server + "\"]",
                 "lab.keys=" + place.keys.string()});
    for (std::string& argument : more) {
      command.push_back("--set");
      command.push_back(std::move(argument));
    }
    return at.start(name, command, std::filesystem::temp_directory_path() / (rig + name));
  };
  auto participant = join(place, "watcher", "viewer");
  auto statuses = *participant.reader(dds::service_status);
  // Its gate is always there; it also writes down who leads, and what is refused.
  auto simulation = spawn("simulation", {"safety.audit=" + audit.string()});
  auto mapping = spawn("mapping", {});
  auto glove = spawn("glove", {fmt::format("glove.rate={}", rate)});
  Stats stats;
  std::uint64_t accepted = 0;
  // A full window that was begun after the start: the world keeps the last 1024.
  const std::uint64_t needed = static_cast<std::uint64_t>(rate) + wanted;
  while (accepted < needed) {
    statuses.raw().wait_for_unread_message({5, 0});
    for (const auto& sample : statuses.take()) {
      if (sample.info.gone || std::string_view(sample.data.name().c_str()) != "simulation")
        continue;
      for (const auto& stage : sample.data.latency())
        if (std::string_view(stage.stage().c_str()) == "glove to accepted")
          stats = {stage.p50_us(), stage.p99_us(), static_cast<std::size_t>(stage.count())};
      for (const auto& r : sample.data.rates())
        if (std::string_view(r.name().c_str()) == "commands") accepted = r.total();
    }
    for (auto* process : {&simulation, &mapping, &glove})
      if (process->exit()) {
        std::cerr << "a service ended: " << stage::last_lines(process->log(), 5) << "\n";
        std::exit(3);
      }
  }
  return stats;
}

int run(bool json, double seconds, const std::vector<std::string>& cases, const std::string& self) {
  const auto folder = stage::TemporaryFolder::create(false);
  if (!folder) {
    std::cerr << folder.error().message() << "\n";
    return 3;
  }
  const std::filesystem::path keys = folder->path() / "keys";
  auto made = stage::Process::start({.command = {(program_directory() / "prehend").string(), "keys",
                                                 "init", keys.string(), "--rig", "any"},
                                     .log = "/dev/null"});
  if (!made || !made->wait(30s)) {
    std::cerr << "prehend keys does not work\n";
    return 3;
  }
  nlohmann::json rows = nlohmann::json::array();
  if (!json)
    fmt::print(
        "| case | rate, Hz | raw p50, ms | raw p99 | lab p50, ms | lab p99 | lab / raw, p50 |\n"
        "|---|---|---|---|---|---|---|\n");
  for (const std::string& name : cases) {
    const Case at(name, keys);
    for (const double rate : {30.0, 500.0}) {
      const auto wanted = static_cast<std::size_t>(std::min(1024.0, rate * seconds));
      const Stats before = measure_floor(rate, wanted, self, at);
      const Stats lab = measure_lab(rate, wanted, at, folder->path() / "audit");
      const Stats after = measure_floor(rate, wanted, self, at);
      const double p50 = 0.5 * (before.p50 + after.p50), p99 = 0.5 * (before.p99 + after.p99);
      rows.push_back({{"case", name},
                      {"rate_hz", rate},
                      {"floor_us", {{"p50", p50}, {"p99", p99}}},
                      {"lab_us", {{"p50", lab.p50}, {"p99", lab.p99}}},
                      {"ratio_of_medians", lab.p50 / p50},
                      {"samples", lab.count}});
      if (json) continue;
      fmt::print("| {} | {:.0f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.2f} |\n", name, rate,
                 1e-3 * p50, 1e-3 * p99, 1e-3 * lab.p50, 1e-3 * lab.p99, lab.p50 / p50);
      std::cout.flush();
    }
  }
  if (json) std::cout << rows.dump() << "\n";
  return 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (argc == 8 && std::string_view(argv[1]).starts_with("--floor-")) {
    const Place place{std::atoi(argv[2]), argv[3], argv[5], argv[6], argv[7]};
    return std::string_view(argv[1]) == "--floor-source" ? floor_source(place, std::atof(argv[4]))
                                                         : floor_relay(place);
  }
  bool json = false;
  double seconds = 8;
  std::vector<std::string> cases;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--json") json = true;
    if (std::string_view(argv[i]) == "--seconds" && i + 1 < argc) seconds = std::atof(argv[++i]);
    if (std::string_view(argv[i]) == "--case" && i + 1 < argc) cases.emplace_back(argv[++i]);
  }
  if (cases.empty()) cases = {"laptop", "containers", "server", "secure", "far"};
  try {
    return run(json, seconds, cases, std::filesystem::read_symlink("/proc/self/exe").string());
  } catch (const std::exception& trouble) {
    std::cerr << trouble.what() << "\n";
    return 3;
  }
}
