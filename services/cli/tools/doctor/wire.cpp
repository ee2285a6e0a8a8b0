#include "services/cli/tools/doctor/wire.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>
#include <vector>

#include "common/dds/sites.hpp"

namespace prehend::cli {
namespace {

constexpr const char* group = "239.255.0.1";  // RTPS 2.2, 9.6.1.4
constexpr int last_domain = 232;

/// RTPS 2.2, 9.6.1.1: where participants of a domain announce themselves.
int announcement_port(int domain) {
  return 7400 + 250 * domain;
}

class Socket {
 public:
  explicit Socket(int type = SOCK_DGRAM)
      : handle_(::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {}
  Socket(Socket&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (handle_ >= 0) ::close(handle_);
  }
  int handle() const { return handle_; }

  bool join(int port, in_addr interface) {
    const int on = 1;
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    ip_mreq membership{};
    ::inet_pton(AF_INET, group, &membership.imr_multiaddr);
    membership.imr_interface = interface;
    address.sin_addr = membership.imr_multiaddr;
    return ::setsockopt(handle_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
           ::bind(handle_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
           ::setsockopt(handle_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) ==
               0;
  }
  int port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    ::getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }

 private:
  int handle_;
};

in_addr interface_of(const service::Config& config) {
  in_addr interface {};
  interface.s_addr = htonl(config.text("lab.network") == "laptop" ? INADDR_LOOPBACK : INADDR_ANY);
  return interface;
}

}  // namespace

Check check_multicast(const service::Config& config) {
  const in_addr interface = interface_of(config);
  const char* hint =
      "let 239.255.0.1 through the firewall (iptables -L -v shows what drops it) and add the route "
      "(ip route add 224.0.0.0/4 dev INTERFACE), or use lab.network = server";
  Socket receiver, sender;
  if (!receiver.join(0, interface))
    return {"multicast", false,
            std::string("the group 239.255.0.1 cannot be joined: ") + std::strerror(errno), hint};
  ::setsockopt(sender.handle(), IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(receiver.port()));
  ::inet_pton(AF_INET, group, &to.sin_addr);
  constexpr std::string_view text = "prehend doctor";
  int error = 0;
  for (int attempt = 0; attempt < 5; ++attempt) {
    if (::sendto(sender.handle(), text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&to),
                 sizeof to) < 0)
      error = errno;
    pollfd waiting{receiver.handle(), POLLIN, 0};
    if (::poll(&waiting, 1, 200) > 0)
      return {"multicast", true, "what is sent to 239.255.0.1 comes back", ""};
  }
  return {"multicast", false,
          error ? std::string("nothing can be sent to 239.255.0.1: ") + std::strerror(error)
                : "what is sent to 239.255.0.1 does not come back",
          hint};
}

std::map<int, int> heard_domains(const service::Config& config, Duration listen) {
  const in_addr interface = interface_of(config);
  std::vector<Socket> sockets;
  std::vector<pollfd> waiting;
  std::vector<int> domains;
  for (int domain = 0; domain <= last_domain; ++domain) {
    Socket socket;
    if (!socket.join(announcement_port(domain), interface)) continue;
    waiting.push_back({socket.handle(), POLLIN, 0});
    domains.push_back(domain);
    sockets.push_back(std::move(socket));
  }
  std::map<int, int> heard;
  const auto end = std::chrono::steady_clock::now() + listen;
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0 ||
        ::poll(waiting.data(), waiting.size(), static_cast<int>(left.count())) <= 0)
      return heard;
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (!(waiting[i].revents & POLLIN)) continue;
      char head[4] = {};
      if (::recv(waiting[i].fd, head, sizeof head, 0) == 4 && std::string_view(head, 4) == "RTPS")
        ++heard[domains[i]];
    }
  }
}

Check check_sites(const service::Config& config) {
  const auto peers = config.names("lab.peers");
  if (peers.empty()) return {"sites", true, "this site listens", ""};
  std::string silent;
  for (const std::string& peer : peers) {
    bool answers = false;
    const auto places = dds::dialled(peer);
    if (!places) return {"sites", false, places.error().message(), places.error().hint};
    std::vector<Socket> calls;
    std::vector<pollfd> waiting;
    for (const dds::Address& place : *places) {
      Socket call(SOCK_STREAM);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(place.port);
      std::memcpy(&address.sin_addr, place.ip.data(), place.ip.size());
      const int done =
          ::connect(call.handle(), reinterpret_cast<sockaddr*>(&address), sizeof address);
      answers = answers || done == 0;
      waiting.push_back({call.handle(), POLLOUT, 0});
      calls.push_back(std::move(call));
    }
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (!answers && !waiting.empty()) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      if (left.count() <= 0 ||
          ::poll(waiting.data(), waiting.size(), static_cast<int>(left.count())) <= 0)
        break;
      std::erase_if(waiting, [&](const pollfd& one) {
        if (one.revents == 0) return false;
        int error = 0;
        socklen_t size = sizeof error;
        ::getsockopt(one.fd, SOL_SOCKET, SO_ERROR, &error, &size);
        answers = answers || error == 0;
        return true;
      });
    }
    if (!answers) (silent += silent.empty() ? "" : ", ") += peer;
  }
  if (silent.empty()) return {"sites", true, "every peer takes calls", ""};
  return {"sites", false, fmt::format("nobody takes the call at {}", silent),
          "start the process that listens there, forward its port on the way, and let TCP through"};
}

}  // namespace prehend::cli
