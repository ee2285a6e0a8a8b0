#include "services/glove/devices/datagrams.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <thread>
#include <utility>

namespace prehend::glove {

Expected<sockaddr_in> parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  sockaddr_in address{};
  address.sin_family = AF_INET;
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  if (colon == std::string::npos ||
      ::inet_pton(AF_INET, text.substr(0, colon).c_str(), &address.sin_addr) != 1 ||
      std::from_chars(text.data() + colon + 1, end, port).ptr != end || port == 0)
    return fail("'" + text + "' is no address", "glove.port", "give one such as 127.0.0.1:9870");
  address.sin_port = htons(port);
  return address;
}

Expected<DatagramReceiver> DatagramReceiver::bind(const std::string& text) {
  const auto address = parse_address(text);
  if (!address) return tl::unexpected(address.error());
  DatagramReceiver made(text);
  made.socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made.socket_ < 0 ||
      ::bind(made.socket_, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return fail(std::strerror(errno), text, "choose a free port on an address of this machine");
  return made;
}

DatagramReceiver::DatagramReceiver(DatagramReceiver&& other) noexcept
    : address_(std::move(other.address_)), socket_(std::exchange(other.socket_, -1)) {}

DatagramReceiver::~DatagramReceiver() {
  if (socket_ >= 0) ::close(socket_);
}

Expected<std::string> DatagramReceiver::read(Duration timeout) {
  using std::chrono::milliseconds;
  const auto wait = std::chrono::ceil<milliseconds>(std::max(timeout, Duration::zero())).count();
  pollfd ready{socket_, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(wait)) <= 0) return std::string();
  std::string bytes(65536, '\0');
  const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (count < 0 && errno != EAGAIN && errno != EINTR)
    return fail(std::strerror(errno), address_, "tries again by itself");
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return bytes;
}

Expected<DatagramSender> DatagramSender::create(const std::string& text) {
  const auto address = parse_address(text);
  if (!address) return tl::unexpected(address.error());
  DatagramSender made(text);
  made.to_ = *address;
  made.socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made.socket_ < 0) return fail(std::strerror(errno), text);
  return made;
}

DatagramSender::DatagramSender(DatagramSender&& other) noexcept
    : address_(std::move(other.address_)),
      to_(other.to_),
      socket_(std::exchange(other.socket_, -1)) {}

DatagramSender::~DatagramSender() {
  if (socket_ >= 0) ::close(socket_);
}

std::string DatagramSender::read(Duration timeout) {
  std::this_thread::sleep_for(timeout);  // nobody answers
  return {};
}

void DatagramSender::write(std::string_view datagram) {
  (void)::sendto(socket_, datagram.data(), datagram.size(), 0,
                 reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
}

}  // namespace prehend::glove
