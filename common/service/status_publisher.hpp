#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/dds/guard/guarded_transport.hpp"
#include "common/dds/participant.hpp"
#include "common/service/status.hpp"

namespace prehend::service {

/// «+3600.000 s», for people.
std::string signed_seconds(Duration duration);

/// This machine's name, 64 characters at most.
std::string host_name();

/// Publishes service/status once a second: what the service counted, the packets and peers that
/// were refused before they reached it, its uptime and memory.
class StatusPublisher {
 public:
  /// instance: whose it is, of several of that name.
  static Expected<StatusPublisher> create(dds::Participant& participant, const std::string& name,
                                          const std::string& host, const std::string& instance,
                                          Time started);
  /// Publishes service/settings, once for all.
  Expected<void> tell_settings(const std::map<std::string, std::string>& settings);

  /// The key of service/status.
  std::string service() const { return message_.service().to_string(); }
  Time next() const { return next_; }
  /// Publishes when it is due, and says when the next one is.
  Time beat(Time now, Status& status, Duration clock_step);
  void publish(Time now, Status& status, Duration clock_step);

 private:
  StatusPublisher(dds::Participant& participant, dds::Writer<v1::ServiceStatus> writer,
                  Time started);
  void count_refusals(Status& status);

  dds::Participant* participant_;
  dds::Writer<v1::ServiceStatus> writer_;
  std::optional<dds::Writer<v1::ServiceSettings>> settings_;
  v1::ServiceStatus message_;
  Time started_{}, next_{};
  std::map<dds::PacketVerdict, std::uint64_t> dropped_;  // packets, as far as the status tells
  std::map<std::string, std::uint64_t> refused_;         // peers, as far as the status tells
};

}  // namespace prehend::service
