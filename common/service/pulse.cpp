#include "common/service/pulse.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "common/service/instance.hpp"

namespace prehend::service {
namespace {

constexpr int max_waiting = 16;  // who asked and was not answered yet
constexpr char answer = '+';

struct Socket {
  explicit Socket(int number) : handle(number) {}
  Socket(const Socket&) = delete;
  ~Socket() {
    if (handle >= 0) ::close(handle);
  }
  int handle;
};

/// An abstract name: it begins with a zero and is no file.
Expected<std::pair<sockaddr_un, socklen_t>> address_of(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.size() + 1 > sizeof address.sun_path)
    return fail("is too long to answer there", name, "shorten lab.rig");
  std::copy(name.begin(), name.end(), address.sun_path + 1);
  const auto length = offsetof(sockaddr_un, sun_path) + 1 + name.size();
  return std::pair(address, static_cast<socklen_t>(length));
}

/// The other side is of our user, or of root.
bool is_ours(int handle) {
  ucred peer{};
  socklen_t length = sizeof peer;
  return ::getsockopt(handle, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 &&
         (peer.uid == ::geteuid() || peer.uid == 0 || ::geteuid() == 0);
}

}  // namespace

std::string pulse_name(const Config& config, const std::string& service) {
  std::string name = fmt::format("prehend/{}/{}/{}", config.integer("lab.domain"),
                                 config.text("lab.rig"), service);
  if (const std::string instance = instance_of(config, service); !instance.empty())
    name += "/" + instance;
  return name;
}

Expected<std::unique_ptr<Pulse>> Pulse::create(const std::string& name, Post post) {
  const auto address = address_of(name);
  if (!address) return tl::unexpected(address.error());
  Socket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (socket.handle < 0 ||
      ::bind(socket.handle, reinterpret_cast<const sockaddr*>(&address->first), address->second) ||
      ::listen(socket.handle, max_waiting) != 0)
    return fail(std::strerror(errno), name, "does another of this name run?");
  return std::unique_ptr<Pulse>(new Pulse(std::exchange(socket.handle, -1), std::move(post)));
}

Pulse::Pulse(int socket, Post post)
    : socket_(socket), post_(std::move(post)), thread_([this] { listen(); }) {}

Pulse::~Pulse() {
  ::shutdown(socket_, SHUT_RDWR);  // ends the waiting of accept()
  thread_.join();
  ::close(socket_);
}

void Pulse::listen() {
  const auto waiting = std::make_shared<std::atomic<int>>(0);
  while (true) {
    const int handle = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (handle < 0) {
      if (errno == EINTR || errno == ECONNABORTED) continue;
      return;
    }
    const auto asked = std::make_shared<Socket>(handle);
    if (!is_ours(handle) || *waiting >= max_waiting) continue;
    ++*waiting;
    post_([asked, waiting] {
      --*waiting;
      (void)::send(asked->handle, &answer, 1, MSG_NOSIGNAL);
    });
  }
}

Expected<void> ask_pulse(const std::string& name, Duration timeout) {
  const auto address = address_of(name);
  if (!address) return tl::unexpected(address.error());
  const Socket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (socket.handle < 0) return fail(std::strerror(errno), name);
  if (::connect(socket.handle, reinterpret_cast<const sockaddr*>(&address->first),
                address->second) != 0)
    return fail("nobody answers there", name, std::strerror(errno));
  if (!is_ours(socket.handle)) return fail("another user answers there", name);
  pollfd ready{socket.handle, POLLIN, 0};
  const auto limit = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  char said = 0;
  if (::poll(&ready, 1, static_cast<int>(limit)) <= 0 || ::recv(socket.handle, &said, 1, 0) != 1 ||
      said != answer)
    return fail("it is there and does not answer", name, "its loop hangs, or it has not begun");
  return {};
}

}  // namespace prehend::service
