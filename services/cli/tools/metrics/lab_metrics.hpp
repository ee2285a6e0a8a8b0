#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/base/time.hpp"
#include "idl/Operation.h"
#include "idl/Robot.h"
#include "services/cli/tools/metrics/exposition.hpp"

namespace prehend::cli {

/// What the services and gates of a rig say of themselves, as metrics. Pure: messages come in with
/// the time at which they were received, by any one clock.
class LabMetrics {
 public:
  /// expected: names of the services that a complete lab has.
  explicit LabMetrics(std::vector<std::string> expected) : expected_(std::move(expected)) {}

  void hear(const v1::ServiceStatus& status, Time now);
  void hear(const v1::ClockBeacon& beacon, Time now);
  void hear(const v1::GateState& gate, Time now);
  /// A service, or the gate of a hand, has said goodbye, or its process was found to be gone.
  void lose_service(const std::string& key);
  void lose_gate(const std::string& hand);

  std::string text(Time now) const;

 private:
  template <class Message>
  struct Heard {
    Message message;
    Time at{};
    bool gone = false;
  };
  template <class Message>
  using ByKey = std::map<std::string, Heard<Message>>;
  using Place = std::pair<std::string, std::string>;  // name and host of a service

  void add_processes(Exposition& page, Time now) const;
  void add_health(Exposition& page, Time now) const;
  void add_work(Exposition& page, Time now) const;
  void add_clocks(Exposition& page, Time now) const;
  void add_gates(Exposition& page, Time now) const;
  void add_stops(Exposition& page, Time now) const;

  std::vector<std::string> expected_;
  ByKey<v1::ServiceStatus> services_;
  ByKey<v1::ClockBeacon> beacons_;
  ByKey<v1::GateState> gates_;
  std::map<Place, std::uint64_t> starts_;
};

}  // namespace prehend::cli
