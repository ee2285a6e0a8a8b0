#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace prehend::service {

/// SIGTERM and SIGINT are waited for by the watchdog alone: a handler must not touch what wakes
/// run(). To be called before any thread starts, so that all of them inherit it.
void block_stop_signals();
void unblock_stop_signals();

/// A thread that waits for signals to stop, and looks whether Fast DDS has locked itself up: then
/// nothing of it can be used any more, not even to leave. It also looks whether a peer was lost
/// that is still there.
class Watchdog {
 public:
  struct Options {
    std::function<void()> on_stop;      // a signal came
    std::function<void()> on_deadlock;  // does not return: the process restarts or ends
    std::function<void()> on_stranded;  // a peer is met again only by who joins anew
    bool looks_for_deadlock = true;     // not in lockstep
  };
  explicit Watchdog(Options options);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  void watch();

  Options options_;
  std::atomic<bool> left_ = false;
  std::thread thread_;
};

}  // namespace prehend::service
