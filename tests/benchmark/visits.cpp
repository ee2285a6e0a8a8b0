// What it costs a secured participant that others come and go: each visitor joins with keys, hears
// a sample of the resident, which is a process of its own, and leaves. All on one machine, over
// loopback.
//
//   benchmark_visits [--visits N] [--at-once N]
//     s       from the first visit to the end of the last
//     heard   visitors that heard the resident within 10 s
//     MB      of the resident, after a tenth of the visits and after all
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

#include "common/base/paths.hpp"
#include "common/dds/participant.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Place {
  int domain = 0;
  std::string rig, keys;

  Expected<dds::Participant> join(const std::string& role) const {
    return dds::Participant::create({.name = role,
                                     .domain = domain,
                                     .rig = rig,
                                     .network = {.profile = "laptop", .keys = keys},
                                     .role = role});
  }
};

/// Says something twenty times a second, and is heard by whoever is there.
int reside(const Place& place) {
  auto participant = place.join("simulation");
  if (!participant) {
    std::cerr << participant.error().message() << "\n";
    return 3;
  }
  auto writer = *participant->writer(dds::lab_beacon);
  auto status = *participant->reader(dds::service_status);
  while (getppid() != 1) {
    writer.write({});
    std::this_thread::sleep_for(50ms);
  }
  return 0;
}

bool visit(const Place& place) {
  auto participant = place.join("glove");
  if (!participant) return false;
  auto reader = *participant->reader(dds::lab_beacon);
  if (!participant->writer(dds::service_status)) return false;
  const auto end = Clock::now() + 10s;
  while (Clock::now() < end) {
    if (!reader.take().empty()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

double resident_mb(pid_t pid) {
  std::ifstream statm(fmt::format("/proc/{}/statm", pid));
  double total = 0, resident = 0;
  statm >> total >> resident;
  return 1e-6 * resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

int measure(int visits, int at_once, const std::string& self) {
  const auto folder = stage::TemporaryFolder::create(false);
  if (!folder) throw std::runtime_error(folder.error().message());
  const test::DomainLease lease;
  const Place place{lease.domain(), fmt::format("visits-{}", getpid()),
                    (folder->path() / "keys").string()};
  auto keys = stage::Process::start({.command = {(program_directory() / "prehend").string(), "keys",
                                                 "init", place.keys, "--rig", "any"},
                                     .log = "/dev/null"});
  if (!keys || !keys->wait(30s)) throw std::runtime_error("prehend keys does not work");
  auto resident = stage::Process::start(
      {.command = {self, "--resident", std::to_string(place.domain), place.rig, place.keys}});
  if (!resident) throw std::runtime_error(resident.error().message());
  if (!visit(place)) throw std::runtime_error("the resident is not heard");

  std::atomic<int> begun = 0, ended = 0, heard = 0;
  std::atomic<double> early_mb = 0;
  const auto start = Clock::now();
  {
    std::vector<std::jthread> crowd;
    for (int n = 0; n < at_once; ++n)
      crowd.emplace_back([&] {
        while (begun++ < visits) {
          heard += visit(place);
          if (++ended == visits / 10) early_mb = resident_mb(resident->pid());
        }
      });
  }
  const std::chrono::duration<double> took = Clock::now() - start;
  fmt::print(
      "| visits | at once | s | heard | MB after a tenth | MB after all |\n"
      "|---|---|---|---|---|---|\n| {} | {} | {:.1f} | {} | {:.1f} | {:.1f} |\n",
      visits, at_once, took.count(), heard.load(), early_mb.load(), resident_mb(resident->pid()));
  return resident->exit() ? 1 : 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (argc == 5 && std::string_view(argv[1]) == "--resident")
    return reside({std::atoi(argv[2]), argv[3], argv[4]});
  int visits = 300, at_once = 4;
  for (int i = 1; i + 1 < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--visits") visits = std::atoi(argv[++i]);
    if (word == "--at-once") at_once = std::atoi(argv[++i]);
  }
  try {
    return measure(visits, at_once, std::filesystem::read_symlink("/proc/self/exe").string());
  } catch (const std::exception& trouble) {
    std::cerr << trouble.what() << "\n";
    return 3;
  }
}
