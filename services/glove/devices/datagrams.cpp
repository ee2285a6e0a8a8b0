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
namespace {

bool is_loopback(in_addr_t address) {
  return ntohl(address) >> 24 == 127;
}

Expected<std::vector<in_addr_t>> parse_senders(const std::vector<std::string>& texts) {
  std::vector<in_addr_t> senders;
  for (const std::string& text : texts) {
    in_addr address{};
    if (::inet_pton(AF_INET, text.c_str(), &address) != 1)
      return fail("'" + text + "' is no address", "glove.senders", "give some such as 192.168.7.2");
    senders.push_back(address.s_addr);
  }
  return senders;
}

/// Takes as long wherever they differ first: how long must not tell how much was guessed.
bool same(std::string_view a, std::string_view b) {
  unsigned char difference = a.size() != b.size();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  return difference == 0;
}

}  // namespace

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

Expected<void> DatagramReceiver::check(const ReceiverOptions& options) {
  const auto address = parse_address(options.address);
  if (!address) return tl::unexpected(address.error());
  if (const auto senders = parse_senders(options.senders); !senders)
    return tl::unexpected(senders.error());
  if (options.secured && !is_loopback(address->sin_addr.s_addr) &&
      (options.senders.empty() || options.token.empty()))
    return fail("with keys, datagrams from other hosts need known senders and a token",
                "glove.port = " + options.address,
                "set glove.senders and glove.token_file, or a port on 127.0.0.1");
  return {};
}

Expected<DatagramReceiver> DatagramReceiver::bind(const ReceiverOptions& options) {
  if (const auto good = check(options); !good) return tl::unexpected(good.error());
  const auto address = parse_address(options.address);
  DatagramReceiver made(options);
  made.senders_ = *parse_senders(options.senders);
  made.socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made.socket_ < 0 ||
      ::bind(made.socket_, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return fail(std::strerror(errno), options.address,
                "choose a free port on an address of this machine");
  return made;
}

DatagramReceiver::DatagramReceiver(DatagramReceiver&& other) noexcept
    : options_(std::move(other.options_)),
      senders_(std::move(other.senders_)),
      socket_(std::exchange(other.socket_, -1)) {}

DatagramReceiver::~DatagramReceiver() {
  if (socket_ >= 0) ::close(socket_);
}

bool DatagramReceiver::hears(const sockaddr_in& sender) const {
  const in_addr_t address = sender.sin_addr.s_addr;
  if (senders_.empty()) return is_loopback(address);
  return std::find(senders_.begin(), senders_.end(), address) != senders_.end();
}

Expected<Datagram> DatagramReceiver::read(Duration timeout) {
  using std::chrono::milliseconds;
  const auto wait = std::chrono::ceil<milliseconds>(std::max(timeout, Duration::zero())).count();
  pollfd ready{socket_, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(wait)) <= 0) return Datagram{};
  Datagram came{std::string(65536, '\0')};
  sockaddr_in sender{};
  socklen_t length = sizeof sender;
  const ssize_t count = ::recvfrom(socket_, came.bytes.data(), came.bytes.size(), 0,
                                   reinterpret_cast<sockaddr*>(&sender), &length);
  if (count < 0) {
    if (errno == EAGAIN || errno == EINTR) return Datagram{};
    return fail(std::strerror(errno), options_.address, "tries again by itself");
  }
  if (!hears(sender)) return Datagram{{}, "unknown sender"};
  came.bytes.resize(static_cast<std::size_t>(count));
  if (options_.token.empty()) return came;
  const std::size_t end = std::min(came.bytes.find('\n'), came.bytes.size());
  if (!same(std::string_view(came.bytes).substr(0, end), options_.token))
    return Datagram{{}, "wrong token"};
  came.bytes.erase(0, end + 1);
  return came;
}

Expected<DatagramSender> DatagramSender::create(const std::string& text, std::string token) {
  const auto address = parse_address(text);
  if (!address) return tl::unexpected(address.error());
  if (!token.empty()) token += '\n';
  DatagramSender made(text, std::move(token));
  made.to_ = *address;
  made.socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made.socket_ < 0) return fail(std::strerror(errno), text);
  return made;
}

DatagramSender::DatagramSender(DatagramSender&& other) noexcept
    : address_(std::move(other.address_)),
      token_(std::move(other.token_)),
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
  const std::string whole = token_ + std::string(datagram);
  (void)::sendto(socket_, whole.data(), whole.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
                 sizeof to_);
}

}  // namespace prehend::glove
