#include "common/service/watchdog.hpp"

#include <pthread.h>
#include <signal.h>

#include <utility>

#include "common/base/log.hpp"
#include "common/dds/guard/guarded_transport.hpp"
#include "common/dds/guard/serialized_transport.hpp"

namespace prehend::service {
namespace {

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  return set;
}

}  // namespace

void block_stop_signals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void unblock_stop_signals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

Watchdog::Watchdog(Options options) : options_(std::move(options)), thread_([this] { watch(); }) {}

Watchdog::~Watchdog() {
  // It waits for a signal; one of our own lets it go.
  left_ = true;
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void Watchdog::watch() {
  const sigset_t waited = stop_signals();
  const timespec while_waiting{0, 250'000'000};
  dds::DeadlockWatchdog deadlock;
  while (!left_) {
    if (sigtimedwait(&waited, nullptr, &while_waiting) > 0) {
      options_.on_stop();
    } else if (options_.looks_for_deadlock && deadlock.look()) {
      log::error("Fast DDS has locked itself up and receives nothing any more");
      options_.on_deadlock();
    } else if (options_.on_stranded && dds::anybody_stranded()) {
      options_.on_stranded();
    }
  }
}

}  // namespace prehend::service
