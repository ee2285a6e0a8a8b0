#include "tests/benchmark/hops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "common/base/paths.hpp"
#include "common/service/status.hpp"

namespace prehend::hops {
namespace {

using namespace std::chrono_literals;

template <class T>
T need(Expected<T> made) {
  if (made) return std::move(*made);
  std::cerr << made.error().message() << "\n";
  std::exit(3);
}

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

}  // namespace

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

std::vector<std::string> floor_command(const std::string& role, double rate, const Place& place) {
  return {own_program(),
          "--floor",
          role,
          std::to_string(rate),
          std::to_string(place.domain),
          place.rig,
          place.network,
          place.server,
          place.keys.string()};
}

std::optional<Floor> floor_of(int argc, char** argv) {
  if (argc != 9 || std::string_view(argv[1]) != "--floor") return std::nullopt;
  return Floor{
      argv[2], std::atof(argv[3]), {std::atoi(argv[4]), argv[5], argv[6], argv[7], argv[8]}};
}

dds::Participant join(const Place& place, const char* name, const char* role) {
  dds::Network network{.profile = place.network, .keys = place.keys};
  if (place.network == "server") network.servers = {place.server};
  return need(dds::Participant::create(
      {.name = name, .domain = place.domain, .rig = place.rig, .network = network, .role = role}));
}

void at_rate(double rate, const std::function<void()>& call) {
  auto next = std::chrono::steady_clock::now();
  while (getppid() != 1) {
    next += std::chrono::nanoseconds(static_cast<long>(1e9 / rate));
    std::this_thread::sleep_until(next);
    call();
  }
}

void wait_for_the_end() {
  while (getppid() != 1) std::this_thread::sleep_for(100ms);
}

Case::Case(const std::string& name, const std::filesystem::path& keys)
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

Place Case::place(const std::string& rig) const {
  Place own = place_;
  own.rig = rig;
  return own;
}

stage::Process Case::start(const std::string& host, std::vector<std::string> command,
                           const std::filesystem::path& log) const {
  if (hosts_ && !host.empty()) command = hosts_->on(host, std::move(command));
  return need(stage::Process::start({.command = std::move(command), .log = log}));
}

stage::Process Case::start_service(const std::string& name, const Place& place,
                                   std::vector<std::string> settings) const {
  settings.insert(settings.end(),
                  {"lab.rig=" + place.rig, fmt::format("lab.domain={}", place.domain),
                   "lab.network=" + place.network, "lab.server=[\"" + place.server + "\"]",
                   "lab.keys=" + place.keys.string()});
  std::vector<std::string> command{(program_directory() / ("prehend-" + name)).string()};
  for (std::string& setting : settings) {
    command.push_back("--set");
    command.push_back(std::move(setting));
  }
  return start(name, command, std::filesystem::temp_directory_path() / (place.rig + name));
}

Plan plan_of(int argc, char** argv, const Plan& defaults) {
  Plan plan{.seconds = defaults.seconds};
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--json") plan.json = true;
    if (i + 1 == argc) continue;
    if (option == "--seconds") plan.seconds = std::atof(argv[++i]);
    if (option == "--rate") plan.rates.push_back(std::atof(argv[++i]));
    if (option == "--case") plan.cases.emplace_back(argv[++i]);
  }
  if (plan.rates.empty()) plan.rates = defaults.rates;
  if (plan.cases.empty()) plan.cases = defaults.cases;
  return plan;
}

namespace {

struct Stats {
  double p50 = 0, p99 = 0;  // µs
  std::size_t count = 0;
};
using Started = std::function<std::vector<stage::Process>()>;

/// Its last process is this one: from the origin of so many robot/command until each has come
/// here, after a second of them.
Stats measure_floor(const Place& place, double rate, std::size_t wanted, const Started& start) {
  auto participant = join(place, "floor-sink", "viewer");
  auto reader = *participant.reader(dds::robot_command);
  std::mutex mutex;
  service::LatencyWindow window;
  std::atomic<std::size_t> seen = 0;
  const auto warm_up = static_cast<std::size_t>(rate);
  Relay<v2::HandCommand> relay([&](const v2::HandCommand& command) {
    const Duration latency = now() - from_ns(command.origin_ns());
    const std::scoped_lock lock(mutex);
    if (++seen > warm_up) window.add(latency);
  });
  reader.raw().set_listener(&relay);
  auto others = start();
  while (seen < warm_up + wanted) std::this_thread::sleep_for(20ms);
  reader.raw().set_listener(nullptr);
  std::reverse(others.begin(), others.end());
  for (auto& other : others) other.stop(1s);
  return {window.quantile_us(0.5), window.quantile_us(0.99), window.count()};
}

/// Its own measure, from its status: from the origin of a command until the gate of the simulation
/// has accepted it, once that has accepted so many.
Stats measure_lab(const Place& place, std::uint64_t accepted, const Started& start) {
  auto participant = join(place, "watcher", "viewer");
  auto statuses = *participant.reader(dds::service_status);
  auto services = start();
  Stats stats;
  std::uint64_t done = 0;
  while (done < accepted) {
    statuses.raw().wait_for_unread_message({5, 0});
    for (const auto& sample : statuses.take()) {
      if (sample.info.gone || std::string_view(sample.data.name().c_str()) != "simulation")
        continue;
      for (const auto& stage : sample.data.latency())
        if (std::string_view(stage.stage().c_str()) == "glove to accepted")
          stats = {stage.p50_us(), stage.p99_us(), static_cast<std::size_t>(stage.count())};
      for (const auto& r : sample.data.rates())
        if (std::string_view(r.name().c_str()) == "commands") done = r.total();
    }
    for (auto& service : services)
      if (service.exit()) {
        std::cerr << "a service ended: " << stage::last_lines(service.log(), 5) << "\n";
        std::exit(3);
      }
  }
  return stats;
}

/// Keys of all roles, of any lab.
std::filesystem::path made_keys(const stage::TemporaryFolder& folder) {
  std::filesystem::path keys = folder.path() / "keys";
  auto making =
      need(stage::Process::start({.command = {(program_directory() / "prehend").string(), "keys",
                                              "init", keys.string(), "--rig", "any"},
                                  .log = "/dev/null"}));
  if (making.wait(30s)) return keys;
  std::cerr << "prehend keys does not work\n";
  std::exit(3);
}

nlohmann::json row_of(const std::string& name, double rate, const Stats& before, const Stats& lab,
                      const Stats& after, bool printed) {
  const double p50 = 0.5 * (before.p50 + after.p50), p99 = 0.5 * (before.p99 + after.p99);
  if (printed)
    fmt::print("| {} | {:.0f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.2f} |\n", name, rate,
               1e-3 * p50, 1e-3 * p99, 1e-3 * lab.p50, 1e-3 * lab.p99, lab.p50 / p50);
  std::fflush(stdout);
  return {{"case", name},
          {"rate_hz", rate},
          {"floor_us", {{"p50", p50}, {"p99", p99}}},
          {"lab_us", {{"p50", lab.p50}, {"p99", lab.p99}}},
          {"ratio_of_medians", lab.p50 / p50},
          {"samples", lab.count}};
}

}  // namespace

void measure(const Plan& plan, const Start& floor, const Start& lab, const Accepted& accepted) {
  const auto folder = need(stage::TemporaryFolder::create(false));
  const auto keys = made_keys(folder);
  if (!plan.json)
    fmt::print(
        "| case | rate, Hz | raw p50, ms | raw p99 | lab p50, ms | lab p99 | lab / raw, p50 |\n"
        "|---|---|---|---|---|---|---|\n");
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& name : plan.cases) {
    const Case at(name, keys);
    for (const double rate : plan.rates) {
      const auto wanted = static_cast<std::size_t>(std::min(1024.0, rate * plan.seconds));
      const auto of_floor = [&] {
        const Place place = at.place(fmt::format("floor-{}-{}", getpid(), rate));
        return measure_floor(place, rate, wanted, [&] { return floor(at, place, rate); });
      };
      const auto of_lab = [&] {
        const Place place = at.place(fmt::format("lab-{}-{}", getpid(), rate));
        return measure_lab(place, accepted(rate, wanted), [&] {
          std::vector<stage::Process> started;
          // Its gate is always there; it also writes down who leads, and what is refused.
          started.push_back(at.start_service(
              "simulation", place, {"safety.audit=" + (folder.path() / "audit").string()}));
          for (stage::Process& other : lab(at, place, rate)) started.push_back(std::move(other));
          return started;
        });
      };
      const Stats before = of_floor(), ours = of_lab(), after = of_floor();
      rows.push_back(row_of(name, rate, before, ours, after, !plan.json));
    }
  }
  if (plan.json) std::cout << rows.dump() << "\n";
}

}  // namespace prehend::hops
