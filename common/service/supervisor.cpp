#include "common/service/supervisor.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "common/base/log_format.hpp"

namespace prehend::service {
namespace {

/// A whole number above zero.
std::optional<std::int64_t> number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value <= 0) return std::nullopt;
  return value;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Sends one datagram and waits for nobody: a supervisor whose socket is full must not stop a hand.
bool send(const std::string& socket, std::string_view state) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(socket.begin(), socket.end(), address.sun_path);
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket.size());
  const int handle = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (handle < 0) return false;
  const bool sent = ::sendto(handle, state.data(), state.size(), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&address), length) >= 0;
  const int reason = errno;
  ::close(handle);
  errno = reason;
  return sent;
}

}  // namespace

constexpr const char* not_by_hand = "systemd sets it; unset it where you start this by hand";

Expected<Supervision> Supervision::from_environment() {
  Supervision found;
  found.socket = variable("NOTIFY_SOCKET");
  if (found.socket.empty()) return found;
  if ((found.socket[0] != '/' && found.socket[0] != '@') || found.socket.size() < 2 ||
      found.socket.size() >= sizeof(sockaddr_un::sun_path))
    return fail("must be a path, or @ and a name", "NOTIFY_SOCKET", not_by_hand);
  const std::string period = variable("WATCHDOG_USEC"), whose = variable("WATCHDOG_PID");
  if (period.empty()) return found;
  const auto us = number(period);
  if (!us) return fail("must be a whole number above 0", "WATCHDOG_USEC", not_by_hand);
  // It is meant for another process, whose child this one is.
  if (!whose.empty() && number(whose) != ::getpid()) return found;
  found.watchdog = std::chrono::microseconds(std::min<std::int64_t>(*us, 86'400'000'000));
  return found;
}

Supervisor::Supervisor() {
  auto found = Supervision::from_environment();
  if (found)
    supervision_ = std::move(*found);
  else
    log::warning(found.error());
}

bool Supervisor::tell(std::string_view state) {
  if (supervision_.socket.empty() || send(supervision_.socket, state)) return true;
  if (!complained_)
    log::warning({std::string("no supervisor can be told how this process fares, which goes on: ") +
                      std::strerror(errno),
                  "NOTIFY_SOCKET=" + supervision_.socket, not_by_hand});
  complained_ = true;
  return false;
}

Time Supervisor::beat(Time now) {
  if (supervision_.socket.empty()) return Time::max();
  if (!ready_) ready_ = tell("READY=1");
  if (!supervision_.watchdog) return Time::max();
  if (now >= next_) {
    tell("WATCHDOG=1");
    next_ = now + *supervision_.watchdog / 2;
  }
  return next_;
}

void Supervisor::stopping() {
  tell("STOPPING=1");
}

}  // namespace prehend::service
