#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"

namespace prehend::service {

/// What a supervisor of processes, as systemd is, wants to hear, and where. Each state is one
/// datagram to a local socket.
struct Supervision {
  std::string socket;  // its path, or @ and a name that is no file; empty: nobody asks
  std::optional<Duration> watchdog;  // who is silent for so long is taken for hung

  /// From NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID, as sd_notify(3) has them.
  static Expected<Supervision> from_environment();
};

/// Tells the supervisor that the process is ready, lives and stops. Called by the loop itself, so
/// that a loop that hangs says nothing.
class Supervisor {
 public:
  /// Warns, and tells nobody anything, where the environment is wrong.
  Supervisor();
  explicit Supervisor(Supervision supervision) : supervision_(std::move(supervision)) {}

  /// The loop runs. Says when it must be told so again, at the latest.
  Time beat(Time now);
  /// The loop ends, and the process with it.
  void stopping();

 private:
  bool tell(std::string_view state);

  Supervision supervision_;
  bool ready_ = false, complained_ = false;
  Time next_{};
};

}  // namespace prehend::service
