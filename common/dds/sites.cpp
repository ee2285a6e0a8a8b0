#include "common/dds/sites.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include "common/dds/guard/tls_front.hpp"
#include "common/dds/guard/wan_transport.hpp"
#include "common/dds/security.hpp"

namespace prehend::dds {

using rtps::IPLocator;

namespace {

/// Where the processes of a listening site are found.
constexpr std::uint16_t first_wan_port = 7420, wan_ports = 16;

Ipv4 ip_of(const rtps::octet* bytes) {
  Ipv4 ip;
  std::copy_n(bytes, ip.size(), ip.begin());
  return ip;
}

rtps::Locator_t locator(std::int32_t kind, const Ipv4& ip = {}) {
  rtps::Locator_t made;
  made.kind = kind;
  made.port = 0;
  made.set_Invalid_Address();
  IPLocator::setIPv4(made, ip.data());
  return made;
}

bool is_free(std::uint16_t port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool free =
      ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(socket);
  return free;
}

/// Keeps a port of this host for one process of the lab, from before it looks whether the port is
/// free until it ends: another may look before it listens. A name of the kernel's, which goes with
/// the process.
class PortLock {
 public:
  /// Nothing: another process has it or listens there.
  static std::shared_ptr<const PortLock> of(std::uint16_t port) {
    auto claim = std::make_shared<PortLock>();
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    const std::string text = fmt::format("prehend-port-{}", port);
    std::ranges::copy(text, name.sun_path + 1);  // after a zero: not a file
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
    const bool ours = ::bind(claim->socket_, reinterpret_cast<const sockaddr*>(&name), size) == 0;
    return ours && is_free(port) ? claim : nullptr;
  }
  PortLock() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  PortLock(const PortLock&) = delete;
  PortLock& operator=(const PortLock&) = delete;
  ~PortLock() { ::close(socket_); }

 private:
  int socket_;
};

/// What others come to: a port, which is its own as long as the participant has it, and with keys
/// who stands before it.
struct Door {
  std::shared_ptr<const PortLock> port;
  std::shared_ptr<const TlsFront> front;
};

/// Our own address on the way to another; 0.0.0.0: there is no way yet.
Ipv4 address_towards(const Address& other) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(first_wan_port);
  std::copy(other.ip.begin(), other.ip.end(), reinterpret_cast<std::uint8_t*>(&address.sin_addr));
  socklen_t size = sizeof address;
  Ipv4 own{};
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
      ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    own = ip_of(reinterpret_cast<const rtps::octet*>(&address.sin_addr));
  ::close(socket);
  return own;
}

void use_tls(transport::TCPv4TransportDescriptor& tcp, const std::filesystem::path& keys) {
  using Tls = transport::TCPTransportDescriptor::TLSConfig;
  tcp.apply_security = true;
  tcp.tls_config.verify_file = keys / key_files::authority;
  tcp.tls_config.cert_chain_file = keys / key_files::certificate;
  tcp.tls_config.private_key_file = keys / key_files::key;
  tcp.tls_config.add_verify_mode(Tls::VERIFY_PEER);
  tcp.tls_config.add_verify_mode(Tls::VERIFY_FAIL_IF_NO_PEER_CERT);
  for (const auto old : {Tls::NO_SSLV2, Tls::NO_SSLV3, Tls::NO_TLSV1, Tls::NO_TLSV1_1})
    tcp.tls_config.add_option(old);
}

struct Listening {
  std::vector<rtps::Locator_t> announced;
  Door door;
};

/// The addresses by which others reach this host; empty: it is alone.
std::vector<Ipv4> own_addresses() {
  std::vector<Ipv4> own;
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return own;
  for (const ifaddrs* one = all; one; one = one->ifa_next)
    if (one->ifa_addr && one->ifa_addr->sa_family == AF_INET && (one->ifa_flags & IFF_UP) &&
        !(one->ifa_flags & IFF_LOOPBACK))
      own.push_back(ip_of(reinterpret_cast<const rtps::octet*>(
          &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr)));
  ::freeifaddrs(all);
  return own;
}

/// Fast DDS itself listens behind the front, on the loopback alone.
Expected<std::shared_ptr<const TlsFront>> stand_before(transport::TCPv4TransportDescriptor& tcp,
                                                       std::uint16_t port,
                                                       const std::filesystem::path& keys) {
  const std::uint16_t inner = free_inner_port();
  tcp.interfaceWhiteList = {"127.0.0.1"};
  tcp.add_listener_port(inner);
  auto front = TlsFront::create({.port = port,
                                 .inner = inner,
                                 .certificate = keys / key_files::certificate,
                                 .key = keys / key_files::key,
                                 .authority = keys / key_files::authority,
                                 .revoked = keys / key_files::revoked});
  if (!front) return tl::unexpected(front.error());
  return std::move(*front);
}

Expected<Listening> listen(transport::TCPv4TransportDescriptor& tcp, const Network& network) {
  std::uint16_t port = 0;
  std::shared_ptr<const PortLock> ours;
  if (!network.listen.empty()) {
    const auto gateway = resolve(network.listen);
    if (!gateway) return tl::unexpected(gateway.error());
    port = gateway->port;
    ours = PortLock::of(port);
    if (!ours)
      return fail(fmt::format("port {} is taken", port), "lab.listen",
                  "each process of a site has a port of its own");
    tcp.set_WAN_address(gateway->ip[0], gateway->ip[1], gateway->ip[2], gateway->ip[3]);
  } else {
    for (port = first_wan_port; !(ours = PortLock::of(port)); ++port)
      if (port + 1 == first_wan_port + wan_ports)
        return fail("all ports from 7420 to 7435 are taken", "lab.network = wan",
                    "end other processes of the lab on this machine");
  }
  std::shared_ptr<const TlsFront> front;
  if (network.keys.empty()) {
    tcp.add_listener_port(port);
  } else {
    auto made = stand_before(tcp, port, network.keys);
    if (!made) return tl::unexpected(made.error());
    front = std::move(*made);
  }
  // Behind the front Fast DDS would announce the loopback, where it listens.
  std::vector<Ipv4> addresses = front ? own_addresses() : std::vector<Ipv4>{};
  if (addresses.empty()) addresses.emplace_back();
  std::vector<rtps::Locator_t> own;
  for (const Ipv4& ip : addresses) {
    own.push_back(locator(LOCATOR_KIND_TCPv4, ip));
    IPLocator::setPhysicalPort(own.back(), port);
    IPLocator::setLogicalPort(own.back(), listens);
  }
  return Listening{std::move(own), {std::move(ours), std::move(front)}};
}

/// Dials all peers, and returns them with our own addresses on the way there.
Expected<std::pair<Dialled, std::set<Ipv4>>> dial(rtps::LocatorList_t& initial,
                                                  const std::vector<std::string>& peers) {
  Dialled all;
  std::set<Ipv4> own;
  for (const std::string& text : peers) {
    const auto places = dialled(text);
    if (!places) return tl::unexpected(places.error());
    own.insert(address_towards(places->front()));
    for (const Address& place : *places) {
      if (!all.emplace(place.ip, place.port).second) continue;
      rtps::Locator_t peer = locator(LOCATOR_KIND_TCPv4, place.ip);
      IPLocator::setPhysicalPort(peer, place.port);
      IPLocator::setLogicalPort(peer, listens);
      initial.push_back(peer);
    }
  }
  return std::pair(std::move(all), std::move(own));
}

}  // namespace

Expected<std::vector<Address>> dialled(const std::string& peer) {
  const auto address = resolve(peer, std::uint16_t{0});
  if (!address) return tl::unexpected(address.error());
  if (address->port != 0) return std::vector{*address};
  std::vector<Address> all;
  for (int n = 0; n < wan_ports; ++n)
    all.push_back({address->ip, static_cast<std::uint16_t>(first_wan_port + n)});
  return all;
}

Expected<void> join_sites(eprosima::fastdds::dds::DomainParticipantQos& qos,
                          const Network& network) {
  auto& all = qos.transport().user_transports;
  const auto found = std::find_if(all.begin(), all.end(), [](const auto& one) {
    return dynamic_cast<transport::TCPv4TransportDescriptor*>(one.get()) != nullptr;
  });
  if (found == all.end()) return fail("has no TCPv4 transport", "profile wan");
  auto& tcp = dynamic_cast<transport::TCPv4TransportDescriptor&>(**found);
  if (!network.keys.empty()) use_tls(tcp, network.keys);

  auto& wire = qos.wire_protocol();
  const rtps::Locator_t group = locator(LOCATOR_KIND_UDPv4, {239, 255, 0, 1});
  wire.builtin.metatrafficMulticastLocatorList.push_back(group);
  wire.builtin.metatrafficUnicastLocatorList.push_back(locator(LOCATOR_KIND_UDPv4));
  wire.default_unicast_locator_list.push_back(locator(LOCATOR_KIND_UDPv4));
  const auto announce = [&](const rtps::Locator_t& own) {
    wire.builtin.metatrafficUnicastLocatorList.push_back(own);
    wire.default_unicast_locator_list.push_back(own);
  };
  Dialled places;
  Door door;
  if (network.peers.empty()) {
    const auto own = listen(tcp, network);
    if (!own) return tl::unexpected(own.error());
    for (const rtps::Locator_t& one : own->announced) announce(one);
    door = own->door;
  } else {
    if (!network.listen.empty())
      return fail("a process listens or dials, not both", "lab.listen",
                  "empty lab.listen where lab.peers names somebody");
    // Who names peers is no longer given the group of its own site.
    wire.builtin.initialPeersList.push_back(group);
    auto called = dial(wire.builtin.initialPeersList, network.peers);
    if (!called) return tl::unexpected(called.error());
    places = std::move(called->first);
    // Of the loopback's addresses: whoever takes it for one to dial is refused at once.
    std::random_device random;
    std::uniform_int_distribution<int> any(0, 255);
    const auto byte = [&] { return static_cast<rtps::octet>(any(random)); };
    tcp.set_WAN_address(127, byte(), byte(), byte());
    for (const Ipv4& ip : called->second) {
      rtps::Locator_t own = locator(LOCATOR_KIND_TCPv4, ip);
      IPLocator::setLogicalPort(own, dials);  // Fast DDS adds its process number
      announce(own);
    }
  }
  *found = wan_transport(*found, std::move(places), std::make_shared<const Door>(std::move(door)));
  return {};
}

}  // namespace prehend::dds
