#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// Hands packets of discovery and of handshakes to one participant one at a time, whichever
/// transport they came by. Fast DDS 2.9.1 receives each port in a thread of its own, and three
/// threads can deadlock:
/// - one removes a secured participant that has left: it holds the lock of the security plugin and
///   waits for the thread of the timers;
/// - the thread of the timers waits for the reader of keys;
/// - the thread of that reader waits for the lock of the security plugin.
/// Two of the three receive packets, so one packet at a time cannot deadlock. Samples by UDP are
/// not serialized: they would wait for handshakes, which take milliseconds.
class SerializedTransport {
 public:
  SerializedTransport();
  ~SerializedTransport();
  SerializedTransport(const SerializedTransport&) = delete;
  SerializedTransport& operator=(const SerializedTransport&) = delete;

  template <class Process>
  void pass(Process&& process) {
    const std::scoped_lock lock(mutex_);
    if (closed_) return;
    enter();
    process();
    packet_ = 0;
  }
  /// Waits for the packet that is being processed; from then on drops all. To be called before the
  /// participant is deleted, which removes all others from it.
  void close();

 private:
  friend std::set<std::uint64_t> packets_in_process();
  void enter();

  std::mutex mutex_;
  bool closed_ = false;
  std::atomic<std::uint64_t> packet_ = 0;  // that is inside; 0: none
};

/// The same transport, whose packets pass through the serializer, which must outlive it; of Fast
/// DDS 3, which does not deadlock, the transport itself.
std::shared_ptr<transport::TransportDescriptorInterface> serialized(
    std::shared_ptr<transport::TransportDescriptorInterface> transport,
    SerializedTransport& serializer);

/// Numbers of the packets that this process is processing in its serializers now.
std::set<std::uint64_t> packets_in_process();

/// Notices a deadlock: look() is to be called every quarter of a second, and is true when one
/// packet has been in process at `max_looks` calls. Calls are counted, not time: time passes for a
/// process that is stopped, too.
class DeadlockWatchdog {
 public:
  static constexpr int max_looks = 7;
  bool look();

 private:
  std::map<std::uint64_t, int> looks_;
};

}  // namespace prehend::dds
