// What leaves through a guarded transport: of what discovery repeats, a place hears once what it
// would hear a hundred times, and everything else passes. Without the guard every packet comes.
#include "common/dds/guard/guarded_transport.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>

#include "tests/support/packets/packets.hpp"

namespace prehend::dds {
namespace {

using test::Bytes;
using test::Message;

/// Listens at an even port of the loopback, as discovery does.
class Listener {
 public:
  Listener() {
    do {
      if (socket_ >= 0) ::close(socket_);
      socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      sockaddr_in own{};
      own.sin_family = AF_INET;
      own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      socklen_t size = sizeof own;
      if (::bind(socket_, reinterpret_cast<sockaddr*>(&own), size) != 0 ||
          ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0)
        throw std::runtime_error("no port");
      port_ = ntohs(own.sin_port);
    } while (port_ % 2 != 0);
    const timeval limit{0, 200'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }
  ~Listener() { ::close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  int port() const { return port_; }
  /// Until nothing more comes.
  int count() const {
    std::array<char, 2048> bytes;
    int all = 0;
    while (::recv(socket_, bytes.data(), bytes.size(), 0) > 0) ++all;
    return all;
  }

 private:
  int socket_ = -1, port_ = 0;
};

#if PREHEND_FAST_DDS == 2
const rtps::octet* pieces(const Bytes& bytes) {
  return bytes.data();
}
#else
std::vector<transport::NetworkBuffer> pieces(const Bytes& bytes) {
  return {{bytes.data(), static_cast<std::uint32_t>(bytes.size())}};
}
#endif

/// How many come, of a hundred that are sent.
int heard(bool paces, const Bytes& bytes) {
  const Listener listener;
  PacketGuard guard(false, false, paces);
  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  const auto descriptor = guarded(udp, guard);
  const std::unique_ptr<transport::TransportInterface> made(descriptor->create_transport());
  rtps::Locator_t to;
  to.kind = LOCATOR_KIND_UDPv4;
  to.port = static_cast<std::uint32_t>(listener.port());
  rtps::IPLocator::setIPv4(to, 127, 0, 0, 1);
  transport::SendResourceList senders;
  if (!made->init() || !made->OpenOutputChannel(senders, to)) throw std::runtime_error("no way");
  const std::vector<rtps::Locator_t> all{to};
  for (int i = 0; i < 100; ++i)
    for (const auto& sender : senders) {
      rtps::Locators begin(all.cbegin()), end(all.cend());
      sender->send(pieces(bytes), static_cast<std::uint32_t>(bytes.size()), &begin, &end,
                   std::chrono::steady_clock::now() + std::chrono::seconds(1));
    }
  return listener.count();
}

TEST(GuardedTransport, SaysTheSameAnnouncementOnceAndAllElseAsOftenAsItIsSaid) {
  const GuidPrefix self = test::participant(1);
  const Message announcement = Message(self).announcement(self, {{127, 0, 0, 1}});
  const int without = heard(false, announcement);
  EXPECT_GE(without, 100);
  EXPECT_EQ(heard(true, announcement), without / 100) << "the next is due after half a second";
  EXPECT_EQ(heard(true, Message(self).departure(self)), without) << "it must arrive";
}

}  // namespace
}  // namespace prehend::dds
