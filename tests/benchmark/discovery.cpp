// How long participants take to find each other, and what that costs on the network. They are real
// processes with what every service has, a writer and a reader of service/status and of lab/beacon,
// spread over ten hosts (network spaces on one bridge, so it needs root), and all start at once.
//
//   benchmark_discovery [--json] [--participants N]... [--network lan|server]...
//     found     s from the start until one, half and all of them had matched everybody
//     late      s that one more takes, who comes when all have met
//     sent      packets and bytes that the hosts put on the bridge until then; and per second
//               afterwards, when nobody writes
//     a pair    packets for each ordered pair on different hosts, from the two largest N:
//               sent = a N + b N (N - N/10)
//   benchmark_discovery --sites ROUNDS
//     two sites by TCP, without and with keys: one process listens, two dial; those who have found
//     everybody within 8 s
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/base/paths.hpp"
#include "common/dds/participant.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"
#include "tests/integration/hosts.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using namespace std::chrono_literals;
namespace fdds = eprosima::fastdds::dds;
using integration::Hosts;
using integration::Traffic;

constexpr int hosts_count = 10;

std::int64_t now_ns() {
  return to_ns(std::chrono::system_clock::now());
}

/// A participant: how it joins, and how many there are with it.
struct Role {
  int domain = 0;
  std::string rig;
  dds::Network network;
  std::string keys_of = "viewer";
  int expected = 0;

  std::vector<std::string> command(const std::string& self) const {
    const auto first = [](const std::vector<std::string>& list) {
      return list.empty() ? std::string() : list.front();
    };
    return {self,
            "--participant",
            std::to_string(domain),
            rig,
            network.profile,
            first(network.servers),
            first(network.peers),
            network.keys.string(),
            keys_of,
            std::to_string(expected)};
  }
  static Role of(char** words) {
    Role role{std::atoi(words[0]), words[1], {.profile = words[2]}, words[6], std::atoi(words[7])};
    if (*words[3]) role.network.servers = {words[3]};
    if (*words[4]) role.network.peers = {words[4]};
    role.network.keys = words[5];
    role.network.insecure = role.network.keys.empty();
    return role;
  }
};

/// Its process: says that it is ready, joins on SIGUSR1, says when it began and when it had matched
/// everybody, and stays.
int participate(const Role& role) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::cout << "ready" << std::endl;
  int number = 0;
  sigwait(&signals, &number);
  const std::int64_t began = now_ns();
  auto participant = dds::Participant::create({.name = "participant",
                                               .domain = role.domain,
                                               .rig = role.rig,
                                               .network = role.network,
                                               .role = role.keys_of});
  if (!participant) {
    std::cerr << participant.error().message() << "\n";
    return 3;
  }
  auto status_writer = *participant->writer(dds::service_status);
  auto beacon_writer = *participant->writer(dds::lab_beacon);
  auto status_reader = *participant->reader(dds::service_status);
  auto beacon_reader = *participant->reader(dds::lab_beacon);
  fdds::WaitSet waiting;
  for (fdds::Entity* entity : {static_cast<fdds::Entity*>(&status_writer.raw()),
                               static_cast<fdds::Entity*>(&beacon_writer.raw()),
                               static_cast<fdds::Entity*>(&status_reader.raw()),
                               static_cast<fdds::Entity*>(&beacon_reader.raw())}) {
    auto& condition = entity->get_statuscondition();
    condition.set_enabled_statuses(fdds::StatusMask::subscription_matched()
                                   << fdds::StatusMask::publication_matched());
    waiting.attach_condition(condition);
  }
  // Its own endpoints match as well.
  const auto has_met_all = [&] {
    int least = role.expected;
    for (auto* writer : {&status_writer.raw(), &beacon_writer.raw()}) {
      fdds::PublicationMatchedStatus status;
      writer->get_publication_matched_status(status);
      least = std::min(least, status.current_count);
    }
    for (auto* reader : {&status_reader.raw(), &beacon_reader.raw()}) {
      fdds::SubscriptionMatchedStatus status;
      reader->get_subscription_matched_status(status);
      least = std::min(least, status.current_count);
    }
    return least >= role.expected;
  };
  while (!has_met_all()) {
    fdds::ConditionSeq active;
    waiting.wait(active, {1, 0});
  }
  std::cout << began << " " << now_ns() << std::endl;
  while (getppid() != 1) std::this_thread::sleep_for(1s);
  return 0;
}

/// Participants that run, each with a file for what it says.
class Crowd {
 public:
  Crowd(const std::filesystem::path& folder, std::string self)
      : folder_(folder), self_(std::move(self)) {}

  void add(const Hosts& hosts, const std::string& host, const Role& role) {
    const auto file = folder_ / std::to_string(count_++);
    auto made = stage::Process::start({.command = hosts.on(host, role.command(self_)),
                                       .log = folder_ / "participants.log",
                                       .output = file});
    if (!made) throw std::runtime_error(made.error().message());
    members_.push_back({std::move(*made), file, {}, {}});
  }
  /// Tells those who were added since to begin.
  std::int64_t begin() {
    for (Member& member : members_)
      while (lines(member).empty()) std::this_thread::sleep_for(5ms);
    const std::int64_t start = now_ns();
    for (; told_ < members_.size(); ++told_) members_[told_].process.signal(SIGUSR1);
    return start;
  }
  /// Until all have met, or for so long.
  bool wait(Duration limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    for (Member& member : members_)
      while (member.met == 0) {
        const auto said = lines(member);
        if (said.size() > 1) std::istringstream(said[1]) >> member.began >> member.met;
        if (member.met == 0 && std::chrono::steady_clock::now() > end) return false;
        if (member.met == 0) std::this_thread::sleep_for(20ms);
      }
    return true;
  }
  /// s after `start` at which each of them had met all, in order; who has not is left out.
  std::vector<double> times(std::int64_t start) const {
    std::vector<double> all;
    for (const Member& member : members_)
      if (member.met > 0) all.push_back(1e-9 * static_cast<double>(member.met - start));
    std::sort(all.begin(), all.end());
    return all;
  }
  /// s that the last one took by itself.
  double last() const {
    return 1e-9 * static_cast<double>(members_.back().met - members_.back().began);
  }
  std::size_t size() const { return members_.size(); }

 private:
  struct Member {
    stage::Process process;
    std::filesystem::path file;
    std::int64_t began = 0, met = 0;
  };
  static std::vector<std::string> lines(const Member& member) {
    std::vector<std::string> said;
    std::ifstream file(member.file);
    for (std::string line; std::getline(file, line) && !file.eof();) said.push_back(line);
    return said;
  }
  std::filesystem::path folder_;
  std::string self_;
  std::size_t told_ = 0;
  int count_ = 0;
  std::vector<Member> members_;
};

Traffic operator-(Traffic late, const Traffic& early) {
  late.sent_packets -= early.sent_packets;
  late.sent_bytes -= early.sent_bytes;
  late.heard_packets -= early.heard_packets;
  late.heard_bytes -= early.heard_bytes;
  return late;
}

struct Row {
  std::string network;
  int participants = 0;
  double first = 0, half = 0, all = 0, late = 0;  // s
  Traffic finding, calm;                          // until all had met; per second afterwards
};

std::string host_name(int n) {
  return "host" + std::to_string(n % hosts_count);
}

/// Nothing: not all met within two minutes.
std::optional<Row> measure(const std::string& network, int n, const std::filesystem::path& folder,
                           const std::string& self) {
  Hosts hosts;
  for (int i = 0; i < hosts_count; ++i) hosts.add(host_name(i));
  const test::DomainLease lease;
  Role role{
      lease.domain(), fmt::format("discovery-{}", getpid()), {.profile = network}, "viewer", n};
  std::optional<stage::Process> server;
  if (network == "server") {
    hosts.add("server");
    role.network.servers = {hosts.address("server") + ":11811"};
    auto made = stage::Process::start(
        {.command = hosts.on("server", {(program_directory() / "prehend").string(),
                                        "discovery-server", "--listen", "0.0.0.0:11811"}),
         .log = folder / "server.log"});
    if (!made) throw std::runtime_error(made.error().message());
    server.emplace(std::move(*made));
    std::this_thread::sleep_for(2s);  // it listens 1.2 s after its start
  }
  const auto place = folder / fmt::format("{}-{}", network, n);
  std::filesystem::create_directories(place);
  Crowd crowd(place, self);
  for (int i = 0; i < n; ++i) crowd.add(hosts, host_name(i), role);
  const Traffic before = hosts.traffic();
  const std::int64_t start = crowd.begin();
  if (!crowd.wait(120s)) {
    std::cerr << fmt::format("{}: {} of {} had met all after two minutes\n", network,
                             crowd.times(start).size(), n);
    return std::nullopt;
  }
  Row row{network, n, 0, 0, 0, 0, hosts.traffic() - before, {}};
  const auto times = crowd.times(start);
  row.first = times.front();
  row.half = times[times.size() / 2];
  row.all = times.back();
  std::this_thread::sleep_for(2s);
  const Traffic calm = hosts.traffic();
  std::this_thread::sleep_for(5s);
  row.calm = hosts.traffic() - calm;
  for (auto* count : {&row.calm.sent_packets, &row.calm.sent_bytes, &row.calm.heard_packets,
                      &row.calm.heard_bytes})
    *count /= 5;
  role.expected = n + 1;
  crowd.add(hosts, host_name(n), role);
  crowd.begin();
  crowd.wait(60s);
  row.late = crowd.last();
  return row;
}

/// a and b of y = a N + b N (N - N/10) through two rows; N/10 of the pairs are on one host.
std::pair<double, double> fit(double n1, double y1, double n2, double y2) {
  const double pairs1 = 0.9 * n1 * n1, pairs2 = 0.9 * n2 * n2;
  const double b = (y2 / n2 - y1 / n1) / (pairs2 / n2 - pairs1 / n1);
  return {y1 / n1 - b * pairs1 / n1, b};
}

/// What 1,000 on hosts of their own would send, by the two largest rows of a network.
nlohmann::json extrapolate(const Row& small, const Row& large) {
  const auto at = [&](auto member, const Traffic Row::*part) {
    const auto value = [&](const Row& row) { return static_cast<double>((row.*part).*member); };
    const auto [a, b] = fit(small.participants, value(small), large.participants, value(large));
    return nlohmann::json{{"a", a}, {"b", b}, {"at_1000", a * 1000 + b * 1000 * 999}};
  };
  return {{"network", large.network},
          {"packets", at(&Traffic::sent_packets, &Row::finding)},
          {"bytes", at(&Traffic::sent_bytes, &Row::finding)},
          {"packets_a_second", at(&Traffic::sent_packets, &Row::calm)},
          {"bytes_a_second", at(&Traffic::sent_bytes, &Row::calm)}};
}

int table(bool json, const std::vector<int>& counts, const std::vector<std::string>& networks,
          const std::filesystem::path& folder, const std::string& self) {
  auto rows = nlohmann::json::array(), formulas = nlohmann::json::array();
  if (!json)
    fmt::print(
        "| network | participants | found: first, s | half | all | one more, s | sent, packets | "
        "MB "
        "| afterwards, packets/s | kB/s |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& network : networks) {
    std::vector<Row> done;
    for (const int n : counts) {
      const auto measured = measure(network, n, folder, self);
      if (!measured) continue;
      const Row& row = *measured;
      done.push_back(row);
      rows.push_back({{"network", network},
                      {"participants", n},
                      {"found_s", {{"first", row.first}, {"half", row.half}, {"all", row.all}}},
                      {"late_s", row.late},
                      {"sent_packets", row.finding.sent_packets},
                      {"sent_bytes", row.finding.sent_bytes},
                      {"packets_a_second", row.calm.sent_packets},
                      {"bytes_a_second", row.calm.sent_bytes}});
      if (json) continue;
      fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {:.2f} | {} | {:.1f} |\n",
                 network, n, row.first, row.half, row.all, row.late, row.finding.sent_packets,
                 1e-6 * static_cast<double>(row.finding.sent_bytes), row.calm.sent_packets,
                 1e-3 * static_cast<double>(row.calm.sent_bytes));
      std::cout.flush();
    }
    if (done.size() > 1) formulas.push_back(extrapolate(done[done.size() - 2], done.back()));
  }
  if (json) {
    std::cout << nlohmann::json{{"rows", rows}, {"extrapolated", formulas}}.dump() << "\n";
    return 0;
  }
  for (const auto& formula : formulas)
    for (const char* what : {"packets", "bytes", "packets_a_second", "bytes_a_second"})
      fmt::print("{}, {}: {:.1f} N + {:.3f} N (N - 1); N = 1000: {:.4g}\n",
                 formula["network"].get<std::string>(), what, formula[what]["a"].get<double>(),
                 formula[what]["b"].get<double>(), formula[what]["at_1000"].get<double>());
  return 0;
}

int sites(int rounds, const std::filesystem::path& folder, const std::string& self) {
  const auto keys = folder / "keys";
  auto made = stage::Process::start({.command = {(program_directory() / "prehend").string(), "keys",
                                                 "init", keys.string(), "--rig", "any"},
                                     .log = "/dev/null"});
  if (!made || !made->wait(30s)) throw std::runtime_error("prehend keys does not work");
  Hosts hosts;
  hosts.add("robot");
  hosts.add("glove");
  for (const auto& [host, other] : {std::pair("robot", "glove"), std::pair("glove", "robot")}) {
    auto drop = stage::Process::start(
        {.command = hosts.on(host, {"iptables", "-A", "INPUT", "-p", "udp", "-s",
                                    hosts.address(other), "-j", "DROP"})});
    if (!drop || drop->wait(10s)->code != 0) throw std::runtime_error("iptables does not work");
  }
  fmt::print("| sites | found | p50, s | last, s |\n|---|---|---|---|\n");
  for (const bool secure : {false, true}) {
    std::vector<double> all;
    for (int round = 0; round < rounds; ++round) {
      const auto place = folder / fmt::format("sites-{}-{}", secure, round);
      std::filesystem::create_directories(place);
      const test::DomainLease lease;
      Role listens{lease.domain(),
                   fmt::format("sites-{}", getpid()),
                   {.profile = "wan", .insecure = !secure},
                   "mapping",
                   3};
      if (secure) listens.network.keys = keys;
      Role dials = listens;
      dials.network.peers = {hosts.address("robot")};
      dials.keys_of = "glove";
      Crowd crowd(place, self);
      crowd.add(hosts, "robot", listens);
      crowd.add(hosts, "glove", dials);
      crowd.add(hosts, "glove", dials);
      const std::int64_t start = crowd.begin();
      crowd.wait(8s);
      for (const double time : crowd.times(start)) all.push_back(time);
    }
    std::sort(all.begin(), all.end());
    fmt::print("| {} | {} of {} | {:.2f} | {:.2f} |\n", secure ? "with keys (TLS)" : "without keys",
               all.size(), 3 * rounds, all.empty() ? 0 : all[all.size() / 2],
               all.empty() ? 0 : all.back());
    std::cout.flush();
  }
  return 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (argc == 10 && std::string_view(argv[1]) == "--participant")
    return participate(Role::of(argv + 2));
  bool json = false;
  int rounds = 0;
  std::vector<int> counts;
  std::vector<std::string> networks;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--json") json = true;
    if (word == "--participants" && i + 1 < argc) counts.push_back(std::atoi(argv[++i]));
    if (word == "--network" && i + 1 < argc) networks.emplace_back(argv[++i]);
    if (word == "--sites" && i + 1 < argc) rounds = std::atoi(argv[++i]);
  }
  if (counts.empty()) counts = {10, 30, 100};
  if (networks.empty()) networks = {"lan", "server"};
  try {
    if (const auto why = Hosts::unavailable()) throw std::runtime_error(*why);
    const auto folder = stage::TemporaryFolder::create(false);
    if (!folder) throw std::runtime_error(folder.error().message());
    const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
    return rounds > 0 ? sites(rounds, folder->path(), self)
                      : table(json, counts, networks, folder->path(), self);
  } catch (const std::exception& trouble) {
    std::cerr << trouble.what() << "\n";
    return 3;
  }
}
