#include "common/base/workers.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace prehend {
namespace {

constexpr unsigned max_threads = 256;

/// What the threads share.
struct Pool {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next = 0, finished = 0;
  unsigned running = 0;
  std::exception_ptr error;

  void run(std::size_t count, const std::function<void(std::size_t)>& work) {
    std::unique_lock lock(mutex);
    while (next < count && !error) {
      const std::size_t mine = next++;
      lock.unlock();
      std::exception_ptr thrown;
      try {
        work(mine);
      } catch (...) {
        thrown = std::current_exception();
      }
      lock.lock();
      if (thrown) error = thrown;
      ++finished;
      changed.notify_one();
    }
    --running;
    changed.notify_one();
  }
};

}  // namespace

void share_work(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work,
                const std::function<void(std::size_t)>& done) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  threads = static_cast<unsigned>(std::min<std::size_t>({threads, count, max_threads}));
  Pool pool;
  pool.running = threads;
  std::vector<std::jthread> crew;
  for (unsigned i = 0; i < threads; ++i) crew.emplace_back([&] { pool.run(count, work); });
  std::unique_lock lock(pool.mutex);
  std::size_t told = 0;
  while (pool.running > 0 || told < pool.finished) {
    pool.changed.wait(lock, [&] { return pool.finished > told || pool.running == 0; });
    if (pool.finished == told) continue;
    told = pool.finished;
    lock.unlock();
    done(told);
    lock.lock();
  }
  lock.unlock();
  crew.clear();
  if (pool.error) std::rethrow_exception(pool.error);
}

}  // namespace prehend
