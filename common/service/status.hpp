#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/named_values.hpp"
#include "common/base/time.hpp"
#include "idl/Operation.h"

namespace prehend::service {

/// What `prehend status` calls the state of a service.
inline constexpr auto state_names =
    named_values<v1::ServiceState>({{v1::STATE_STARTING, "starting"},
                                    {v1::STATE_RUNNING, "running"},
                                    {v1::STATE_DEGRADED, "degraded"},
                                    {v1::STATE_STOPPING, "stopping"}});

/// The last 1024 values of a latency.
class LatencyWindow {
 public:
  void add(Duration latency);
  /// Quantile in µs, 0 when empty. q in [0, 1].
  double quantile_us(double q) const;
  double max_us() const;
  std::size_t count() const { return count_; }

 private:
  std::array<double, 1024> values_us_{};
  std::size_t next_ = 0, count_ = 0;
};

/// What a service says about its health, once a second. Safe from every thread.
class Status {
 public:
  void count(std::string_view what, std::uint64_t n = 1);   // rates: frames, commands, ...
  void drop(std::string_view reason, std::uint64_t n = 1);  // input that was not used, and why
  void latency(std::string_view stage, Duration latency);
  void running();
  /// Works, but not fully; the message says what is missing and what to do.
  void degraded(std::string message);
  /// Something that is wrong beside that, and degrades it as well; empty: nothing any more.
  void note(std::string trouble);
  std::uint64_t dropped(std::string_view reason) const;

  /// Fills rates (per second since the last call), drops, latency, state and message.
  void fill(v1::ServiceStatus& message, Time now);

 private:
  struct Counter {
    std::uint64_t total = 0, last = 0;
  };
  mutable std::mutex mutex_;
  v1::ServiceState state_ = v1::STATE_STARTING;
  std::string message_, note_;
  std::map<std::string, Counter, std::less<>> counts_;
  std::map<std::string, std::uint64_t, std::less<>> drops_;
  std::map<std::string, LatencyWindow, std::less<>> latencies_;
  Time last_fill_{};
};

}  // namespace prehend::service
