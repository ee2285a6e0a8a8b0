#pragma once

#include <unistd.h>

#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/participant.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"
#include "tests/integration/hosts.hpp"
#include "tests/support/domains/domain_lease.hpp"

/// What benchmarks of latency share: processes that pass messages over some hops, as a floor, and
/// the lab's own measure beside it. Whatever cannot be made ends the program with code 3.
namespace prehend::hops {

Time now();

/// Where a process of the run is and how it reaches the others.
struct Place {
  int domain = 0;
  std::string rig, network = "laptop", server;
  std::filesystem::path keys;  // of all roles; empty: not secured
};

/// A process of a floor, as it is started: what it is, how many messages a second, and where.
std::vector<std::string> floor_command(const std::string& role, double rate, const Place& place);
struct Floor {
  std::string role;
  double rate = 0;
  Place place;
};
/// What this process was started as; nothing: it is no part of a floor.
std::optional<Floor> floor_of(int argc, char** argv);

/// role: whose keys it has.
dds::Participant join(const Place& place, const char* name, const char* role);

/// Calls `handle` in the thread that received the sample: nothing between wire and code.
template <class T>
class Relay : public eprosima::fastdds::dds::DataReaderListener {
 public:
  explicit Relay(std::function<void(const T&)> handle) : handle_(std::move(handle)) {}
  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override {
    T sample;
    eprosima::fastdds::dds::SampleInfo info;
    while (dds::succeeded(reader->take_next_sample(&sample, &info)))
      if (info.valid_data) handle_(sample);
  }

 private:
  std::function<void(const T&)> handle_;
};

/// Calls that so many times a second, until whoever started this process is gone.
void at_rate(double rate, const std::function<void()>& call);
/// Until whoever started this process is gone.
void wait_for_the_end();

/// A case of a table, while it is measured: its place, and on which host each process runs.
class Case {
 public:
  /// name: laptop, containers, server, secure or far. Throws when the hosts cannot be made.
  Case(const std::string& name, const std::filesystem::path& keys);

  /// `rig` alone: what went before is still told of.
  Place place(const std::string& rig) const;
  stage::Process start(const std::string& host, std::vector<std::string> command,
                       const std::filesystem::path& log = "/dev/null") const;
  /// prehend-NAME of the lab at that place, with more settings.
  stage::Process start_service(const std::string& name, const Place& place,
                               std::vector<std::string> settings) const;

 private:
  const test::DomainLease lease_;
  Place place_;
  std::optional<integration::Hosts> hosts_;
  std::optional<stage::Process> server_;
};

struct Stats {
  double p50 = 0, p99 = 0;  // µs
  std::size_t count = 0;
};

/// A floor's last process is this one: from the origin of so many robot/command until each has come
/// here, after a second of them. `start` starts the others.
Stats measure_floor(const Place& place, double rate, std::size_t wanted,
                    const std::function<std::vector<stage::Process>()>& start);

/// The lab's own measure, from its status: from the origin of a command until the gate of the
/// simulation has accepted it, once that has accepted so many. `start` starts the services.
Stats measure_lab(const Place& place, std::uint64_t accepted,
                  const std::function<std::vector<stage::Process>()>& start);

/// A table of what was measured, printed row by row as it grows, or as JSON at its end.
class Table {
 public:
  using Measure = std::function<Stats(double rate, std::size_t wanted)>;

  explicit Table(bool json);
  /// Floor, lab and floor again, each of so many seconds' messages: a machine that changes its
  /// speed changes both.
  void measure(const std::string& name, double rate, double seconds, const Measure& floor,
               const Measure& lab);
  void end() const;

 private:
  bool json_;
  nlohmann::json rows_ = nlohmann::json::array();
};

/// Keys of all roles, of any lab, in a folder of that one.
std::filesystem::path made_keys(const stage::TemporaryFolder& folder);
stage::TemporaryFolder made_folder();

}  // namespace prehend::hops
