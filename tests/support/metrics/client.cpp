#include "tests/support/metrics/client.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cstdint>

namespace prehend::tests {

Client::Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval limit{30, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
}

Client::~Client() {
  ::close(socket_);
}

void Client::say(std::string_view text) const {
  (void)::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
}

void Client::end() const {
  ::shutdown(socket_, SHUT_WR);
}

std::string Client::hear() const {
  std::string all;
  std::array<char, 4096> bytes;
  for (ssize_t size; (size = ::recv(socket_, bytes.data(), bytes.size(), 0)) > 0;)
    all.append(bytes.data(), static_cast<std::size_t>(size));
  return all;
}

}  // namespace prehend::tests
