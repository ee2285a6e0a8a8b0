#pragma once

#include <unistd.h>

#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <filesystem>
#include <functional>
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

/// What is measured, by the arguments of a program: [--json] [--seconds S] [--rate HZ]...
/// [--case NAME]...
struct Plan {
  double seconds = 0;  // of each measurement
  std::vector<double> rates;
  std::vector<std::string> cases;
  bool json = false;
};
/// Over these defaults.
Plan plan_of(int argc, char** argv, const Plan& defaults);

/// The processes of a floor, or of the lab, at that place.
using Start =
    std::function<std::vector<stage::Process>(const Case& at, const Place& place, double rate)>;
/// How many accepted commands of the lab are as many messages as a floor passes: `wanted`, after a
/// second of them.
using Accepted = std::function<std::uint64_t(double rate, std::size_t wanted)>;

/// Floor, lab and floor again, for each case and rate: a machine that changes its speed changes
/// both. A table, row by row as it grows, or JSON at its end. The lab's simulation writes its audit
/// as everywhere; `lab` starts the services beside it.
void measure(const Plan& plan, const Start& floor, const Start& lab, const Accepted& accepted);

}  // namespace prehend::hops
