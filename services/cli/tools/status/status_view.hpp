#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.hpp"
#include "idl/Operation.h"
#include "idl/Robot.h"

namespace prehend::cli {

/// Who is in a rig and how they fare, as a page of text or a JSON document. Pure: messages come in
/// with the time at which they were received, by any one clock.
class StatusView {
 public:
  /// expected: names of the services that a complete lab has.
  explicit StatusView(std::vector<std::string> expected) : expected_(std::move(expected)) {}

  /// middleware: what its process speaks with, as «Fast DDS 3.1.2»; empty: not known.
  void hear(const v1::ServiceStatus& status, Time now, const std::string& middleware = {});
  void hear(const v1::ClockBeacon& beacon, Time now);
  void hear(const v1::GateState& gate, Time now);
  /// A service has said goodbye, or its process was found to be gone.
  void lose(const std::string& key, Time now);

  /// Peers that this process does not let in, with the reason.
  void refuse(std::vector<std::string> peers) { refused_ = std::move(peers); }

  /// How many services of this name say of themselves that they work, and do so still.
  std::size_t up(std::string_view name, Time now) const;
  bool empty() const { return services_.empty(); }
  /// Names of expected services of which none is heard.
  std::vector<std::string> missing(Time now) const;

  /// Lines of at most 100 characters as long as names are of usual length.
  std::string page(Time now) const;
  std::string json(Time now) const;

 private:
  struct Service {
    v1::ServiceStatus status;
    Time heard{};
    bool gone = false;
    std::string middleware;
    /// Of each reason, what came since the message before.
    std::map<std::string, std::uint64_t> fresh_drops;
  };
  struct Clock {
    std::string against;                 // key of the service whose clock is the measure
    double offset = 0, uncertainty = 0;  // s
  };
  /// Silent for longer than a service ever is.
  bool is_silent(const Service& service, Time now) const;
  /// The beacon of the service that knows most clocks; nullptr: none is heard.
  const v1::ClockBeacon* measure(Time now) const;
  std::optional<Clock> clock(const std::string& key, Time now) const;
  std::string state(const Service& service, Time now) const;
  /// Its name, and where there are others of that name, whose it is.
  std::string title(const Service& service) const;
  std::string gates(Time now) const;
  std::string strangers() const;

  std::vector<std::string> expected_, refused_;
  bool told_ = false;                        // what somebody speaks with
  std::map<std::string, Service> services_;  // by key
  std::map<std::string, std::pair<v1::ClockBeacon, Time>> beacons_;
  std::map<std::string, std::pair<v1::GateState, Time>> gates_;  // by hand
};

}  // namespace prehend::cli
