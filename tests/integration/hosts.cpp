#include "tests/integration/hosts.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace prehend::integration {
namespace {

using Command = std::vector<std::string>;

stage::Process start(Command command, const std::filesystem::path& log = "/dev/null") {
  auto made = stage::Process::start({.command = std::move(command), .log = log});
  if (!made) throw std::runtime_error(made.error().message());
  return std::move(*made);
}

void run(Command command) {
  const std::string text = fmt::format("{}", fmt::join(command, " "));
  const auto exit = start(std::move(command)).wait(seconds(10));
  if (!exit || exit->code != 0) throw std::runtime_error("failed: " + text);
}

std::string space(pid_t pid) {
  std::error_code code;
  return std::filesystem::read_symlink(fmt::format("/proc/{}/ns/net", pid), code).string();
}

/// A process that only keeps a space alive.
stage::Process keep_space() {
  auto keeper = start({"unshare", "--net", "--uts", "sleep", "infinity"});
  for (int i = 0; i < 1000; ++i) {
    const std::string made = space(keeper.pid());
    if (!made.empty() && made != space(::getpid())) return keeper;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  throw std::runtime_error("no network space can be made");
}

Command inside(const stage::Process& keeper, Command command) {
  Command whole{"nsenter", fmt::format("--net=/proc/{}/ns/net", keeper.pid()),
                fmt::format("--uts=/proc/{}/ns/uts", keeper.pid())};
  whole.insert(whole.end(), command.begin(), command.end());
  return whole;
}

}  // namespace

std::optional<std::string> Hosts::unavailable() {
  if (::geteuid() != 0) return "making hosts of network spaces needs root";
  for (const char* tool : {"/usr/bin/unshare", "/usr/bin/nsenter"})
    if (::access(tool, X_OK) != 0) return std::string(tool) + " is missing";
  const auto works = stage::Process::start(
      {.command = {"unshare", "--net", "--uts", "sh", "-c",
                   "ip link add br0 type bridge && iptables -A INPUT -m statistic --mode random "
                   "--probability 0.5 -j DROP && test -c /dev/net/tun"},
       .log = "/dev/null"});
  if (!works) return works.error().message();
  auto process = std::move(const_cast<stage::Process&>(*works));
  const auto exit = process.wait(seconds(10));
  if (!exit || exit->code != 0)
    return "network spaces, bridges, iptables or /dev/net/tun do not work here";
  return std::nullopt;
}

Hosts::Hosts(std::string way) : way_(std::move(way)) {
  bridge_ = keep_space();
  // Snooping would drop multicast that no router asks for.
  run(bridge({"ip", "link", "add", "br0", "type", "bridge", "mcast_snooping", "0"}));
  run(bridge({"ip", "link", "set", "br0", "up"}));
}

Hosts::~Hosts() {
  if (home_ < 0) return;
  ::setns(home_, CLONE_NEWNET);
  ::close(home_);
}

std::vector<std::string> Hosts::bridge(Command command) const {
  return inside(*bridge_, std::move(command));
}

const Hosts::Host& Hosts::host(const std::string& name) const {
  for (const auto& one : hosts_)
    if (one->name == name) return *one;
  throw std::runtime_error("no host " + name);
}

std::vector<std::string> Hosts::on(const std::string& name, Command command) const {
  return inside(host(name).keeper, std::move(command));
}

std::string Hosts::address(const std::string& name) const {
  return fmt::format("10.77.0.{}", host(name).number);
}

void Hosts::add(const std::string& name, const Distance& distance) {
  const int number = static_cast<int>(hosts_.size()) + 1;
  hosts_.push_back(std::make_unique<Host>(Host{name, number, keep_space(), std::nullopt}));
  Host& made = *hosts_.back();
  const std::string port = fmt::format("port{}", number);
  run(on(name, {"hostname", name}));
  if (distance.delay_ms <= 0) {
    run(bridge({"ip", "link", "add", port, "type", "veth", "peer", "name", "eth0", "netns",
                std::to_string(made.keeper.pid())}));
  } else {
    made.delay_line =
        start({way_, std::to_string(made.keeper.pid()), "eth0", std::to_string(bridge_->pid()),
               port, std::to_string(distance.delay_ms), std::to_string(distance.jitter_ms)},
              std::filesystem::temp_directory_path() / "prehend-delay-line.log");
    // It makes both ends.
    for (int i = 0; i < 400; ++i) {
      const auto there = start(bridge({"ip", "link", "show", port})).wait(seconds(5));
      const auto here = start(on(name, {"ip", "link", "show", "eth0"})).wait(seconds(5));
      if (there && here && there->code == 0 && here->code == 0) break;
    }
  }
  run(bridge({"ip", "link", "set", port, "master", "br0", "up"}));
  run(on(name, {"ip", "link", "set", "lo", "up"}));
  run(on(name, {"ip", "address", "add", address(name) + "/24", "dev", "eth0"}));
  run(on(name, {"ip", "link", "set", "eth0", "up"}));
  run(on(name, {"ip", "route", "add", "default", "dev", "eth0"}));
  // Linux asks for an address that did not answer again after 1 s: after a cable was out that
  // second would be most of what is measured. As deploy/dds/README.md advises.
  run(on(name, {"ip", "ntable", "change", "name", "arp_cache", "dev", "eth0", "retrans", "100"}));
}

void Hosts::enter(const std::string& name) {
  if (home_ < 0) home_ = ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
  enter_for_good(name);
}

void Hosts::enter_for_good(const std::string& name) const {
  const int there =
      ::open(fmt::format("/proc/{}/ns/net", host(name).keeper.pid()).c_str(), O_RDONLY | O_CLOEXEC);
  const bool moved = there >= 0 && ::setns(there, CLONE_NEWNET) == 0;
  ::close(there);
  if (!moved) throw std::runtime_error("cannot enter host " + name);
}

void Hosts::refuse(const std::string& name, const std::string& other) {
  run(on(name, {"iptables", "-A", "INPUT", "-s", address(other), "-j", "DROP"}));
}

void Hosts::link(const std::string& name, bool up) {
  run(bridge({"ip", "link", "set", fmt::format("port{}", host(name).number), up ? "up" : "down"}));
}

void Hosts::lose(const std::string& name, double share) {
  for (const char* chain : {"INPUT", "OUTPUT"}) {
    run(on(name, {"iptables", "-F", chain}));
    if (share > 0)
      run(on(name,
             {"iptables", "-A", chain, chain[0] == 'I' ? "-i" : "-o", "eth0", "-m", "statistic",
              "--mode", "random", "--probability", std::to_string(share), "-j", "DROP"}));
  }
}

Traffic Hosts::traffic() const {
  Traffic all;
  std::ifstream devices(fmt::format("/proc/{}/net/dev", bridge_->pid()));
  for (std::string line; std::getline(devices, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || line.find("port") > colon) continue;
    // Received by the port: bytes, packets and six more; then transmitted, the same.
    std::istringstream numbers(line.substr(colon + 1));
    std::array<std::uint64_t, 10> n{};
    for (std::uint64_t& one : n) numbers >> one;
    all.sent_bytes += n[0];
    all.sent_packets += n[1];
    all.heard_bytes += n[8];
    all.heard_packets += n[9];
  }
  return all;
}

}  // namespace prehend::integration
