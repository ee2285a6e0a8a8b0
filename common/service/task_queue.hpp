#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>

#include "common/base/time.hpp"

namespace prehend::service {

/// Tasks for the thread of run(), and what wakes it. Safe from every thread.
class TaskQueue {
 public:
  void post(std::function<void()> task);
  void wake();
  /// Runs what has been posted, in the calling thread.
  void run();
  /// Until something wakes it, or for `limit` at most.
  void wait(Duration limit);

 private:
  std::mutex mutex_;  // guards what follows
  std::condition_variable condition_;
  std::deque<std::function<void()>> tasks_;
  bool woken_ = false;
};

}  // namespace prehend::service
