#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>

namespace eprosima::fastdds::rtps {
struct TransportDescriptorInterface;
}

namespace prehend::dds {

/// Lets the packets of discovery and of handshakes into one participant, from whichever transport,
/// one at a time. Fast DDS 2.9.1 receives each port in a thread of its own, and three of them can
/// wait for each other for good: one forgets a secured participant that has left, holds the lock of
/// its security and waits for the timers' thread; that waits for the reader of keys; whose thread
/// waits for the security's lock. Of these three two receive. Samples of UDP pass beside the gate:
/// a handshake takes milliseconds.
class Gate {
 public:
  Gate();
  ~Gate();
  Gate(const Gate&) = delete;
  Gate& operator=(const Gate&) = delete;

  template <class Process>
  void pass(Process&& process) {
    const std::scoped_lock lock(mutex_);
    if (closed_) return;
    enter();
    process();
    packet_ = 0;
  }
  /// For good, when nobody is in it any more: who deletes a participant forgets all others.
  void close();

 private:
  friend std::set<std::uint64_t> packets_in_hand();
  void enter();

  std::mutex mutex_;
  bool closed_ = false;
  std::atomic<std::uint64_t> packet_ = 0;  // that is inside; 0: none
};

/// The same transport, behind a gate, which must outlive it.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> gated(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport, Gate& gate);

/// Numbers of the packets that this process is just processing behind its gates.
std::set<std::uint64_t> packets_in_hand();

/// Notices that a process has gone deaf: a packet in hand at `most` looks, half a second apart,
/// will be for ever. Looks are counted, not time, which passes for a process that is stopped, too.
class DeafnessWatch {
 public:
  static constexpr int most = 4;
  bool look();

 private:
  std::map<std::uint64_t, int> looks_;
};

}  // namespace prehend::dds
