#pragma once

#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/clock/peers.hpp"
#include "common/dds/participant.hpp"

namespace prehend::service {

/// Clock synchronisation of a live service: sends lab/beacon, hears those of others in the thread
/// that receives them, and says how far a peer's clock is ahead of ours. Safe from every thread.
class ClockSync {
 public:
  /// `service` is that of service/status. The participant must outlive it, and be ended first.
  static Expected<std::unique_ptr<ClockSync>> create(dds::Participant& participant,
                                                     const std::string& service,
                                                     const std::string& host, Time started);

  struct Ahead {
    Duration stamps{}, sent{};  // of what the peer stamps, and of what its system clock stamps
  };
  Ahead ahead(const dds::SampleInfo& info) const;
  /// The service that wrote; empty: not known.
  std::string service_of(const dds::SampleInfo& info) const;
  /// How far the system's clock was set since the start; this process keeps its own.
  Duration clock_step() const;

  /// Sends a beacon when one is due, and says when the next one is.
  Time beat(Time now);

 private:
  class Listener;
  ClockSync(const std::string& service, const std::string& host, Time started);
  void hear(const dds::Sample<v1::ClockBeacon>& sample, Time received);
  void send();

  std::unique_ptr<eprosima::fastdds::dds::DataReaderListener> listener_;
  std::optional<dds::Writer<v1::ClockBeacon>> writer_;
  Time started_{}, next_{};
  mutable std::mutex mutex_;  // guards what follows
  clock::Peers peers_;
  Time last_{};
  Duration step_{};
};

}  // namespace prehend::service
