#include "common/dds/network.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/dds/dds_log.hpp"
#include "common/dds/guard/packet.hpp"
#include "common/dds/server_watch.hpp"
#include "common/dds/sites.hpp"

namespace prehend::dds {

namespace {

constexpr std::uint32_t participants_of_a_host = 32;  // that are asked, as ROS 2 does

/// Every variable by which Fast DDS lets itself be changed.
constexpr std::pair<const char*, const char*> variables[] = {
    {profiles_variable, "names profiles that Fast DDS takes as its defaults"},
    {"ROS_DISCOVERY_SERVER", "turns participants into clients of a discovery server"},
    {"FASTDDS_ENVIRONMENT_FILE", "names a file with further variables"},
    {"FASTDDS_STATISTICS", "adds writers to every participant"},
    {"FASTDDS_BUILTIN_TRANSPORTS", "chooses other transports"},
};

/// A profile as it stands in its file. Each file is read once.
Expected<fdds::DomainParticipantQos> load(const std::string& profile) {
  const std::string file = (share_directory() / "dds" / (profile + ".xml")).string();
  const std::string hint =
      "put it right, put back the file from deploy/dds, or choose another lab.network";
  static std::mutex mutex;
  static std::map<std::string, fdds::DomainParticipantQos> known;
  const std::scoped_lock lock(mutex);
  if (const auto found = known.find(file); found != known.end()) return found->second;

  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code))
    return fail("there is no such profile", file, hint);
  auto* factory = fdds::DomainParticipantFactory::get_instance();
  DdsLog::Capture complaints("XMLPARSER");
  const auto loaded = factory->load_XML_profiles_file(file);
  fdds::DomainParticipantQos qos;
  const auto found = factory->get_participant_qos_from_profile(profile, qos);
  const std::string said = complaints.text();
  // The first complaint names the place, the others what follows from it.
  if (!said.empty()) return fail("cannot be used: " + said.substr(0, said.find(';')), file, hint);
  if (!succeeded(loaded)) return fail("cannot be read", file, hint);
  if (!succeeded(found))
    return fail(fmt::format("has no participant profile \"{}\"", profile), file, hint);
  known.emplace(file, qos);
  return qos;
}

/// What must be true of a profile whatever else is changed in it; empty: it is.
std::string violation(const std::string& profile, const fdds::DomainParticipantQos& qos) {
  if (qos.transport().use_builtin_transports)
    return "useBuiltinTransports is on, which adds shared memory";
  // Fast DDS passes over a transport that it does not know, if there is another.
  if (qos.transport().user_transports.size() != (profile == "wan" ? 2 : 1))
    return profile == "wan" ? "it has not two transports" : "it has not one transport";
  for (const auto& given : qos.transport().user_transports) {
    const auto* udp = dynamic_cast<transport::UDPv4TransportDescriptor*>(given.get());
    const auto* tcp = dynamic_cast<transport::TCPv4TransportDescriptor*>(given.get());
    if (!udp && profile != "wan") return "it is not UDPv4 only";
    if (!udp && !tcp) return "its transports are not UDPv4 and TCPv4";
    if (profile == "laptop" && udp->interfaceWhiteList != std::vector<std::string>{"127.0.0.1"})
      return "it is not confined to 127.0.0.1";
  }
  const auto protocol = qos.wire_protocol().builtin.discovery_config.discoveryProtocol;
  const auto due = profile == "server" ? DiscoveryProtocol::CLIENT : DiscoveryProtocol::SIMPLE;
  if (protocol != due)
    return profile == "server" ? "discoveryProtocol is not CLIENT"
                               : "discoveryProtocol is not SIMPLE";
  return {};
}

/// Fast DDS joins without a word where there is nothing to send through.
Expected<void> need_interface(const std::string& profile) {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0)
    return fail("the interfaces cannot be listed", profile, std::strerror(errno));
  bool found = false;
  for (const ifaddrs* one = all; one; one = one->ifa_next)
    found |= one->ifa_addr && one->ifa_addr->sa_family == AF_INET && (one->ifa_flags & IFF_UP) &&
             (profile != "laptop" || (one->ifa_flags & IFF_LOOPBACK));
  ::freeifaddrs(all);
  if (found) return {};
  return fail(profile == "laptop" ? "the loopback interface is down" : "no interface is up",
              "lab.network = " + profile, "as root: ip link set lo up");
}

Expected<void> use_servers(fdds::DomainParticipantQos& qos, const Network& network,
                           const DiscoveryOptions& discovery) {
  auto& builtin = qos.wire_protocol().builtin;
  // Seen with 2.9.1: such clients never find each other.
  if (!network.keys.empty())
    return fail("discovery servers of Fast DDS 2.9 cannot be secured", "lab.keys",
                "use lab.network = lan");
  if (!discovery.serves.empty()) {
    const auto own = resolve(discovery.serves, first_server_port);
    if (!own) return tl::unexpected(own.error());
    builtin.discovery_config.discoveryProtocol = DiscoveryProtocol::SERVER;
    builtin.metatrafficUnicastLocatorList.push_back(locator_of(*own));
    qos.wire_protocol().prefix = server_prefix(own->port);
    // A server that is started again knows nobody, and its clients tell it of themselves anew only
    // after they have missed it. They keep each other meanwhile.
    builtin.discovery_config.leaseDuration = {1, 0};
    builtin.discovery_config.leaseDuration_announcementperiod = {0, 200'000'000};
  } else if (network.servers.empty()) {
    return fail("names no discovery server", "lab.server",
                "give ADDRESS:PORT of `prehend discovery-server`");
  } else if (discovery.sees_all) {
    builtin.discovery_config.discoveryProtocol = DiscoveryProtocol::SUPER_CLIENT;
  }
  for (const std::string& text : network.servers) {
    const auto address = resolve(text, first_server_port);
    if (!address) return tl::unexpected(address.error());
    if (server_prefix(address->port) == qos.wire_protocol().prefix)
      return fail("linked discovery servers must have different ports", text,
                  "the first listens at 11811, the next at 11812");
    add_server(qos, *address);
  }
  return {};
}

/// Fast DDS asks hosts that are named instead of the group, at the ports of its first participants.
Expected<void> ask_hosts(fdds::DomainParticipantQos& qos, const std::vector<std::string>& hosts) {
  auto& asked = qos.wire_protocol().builtin.initialPeersList;
  asked.push_back(locator_of({{239, 255, 0, 1}, 0}));
  for (const std::string& host : hosts) {
    if (host.find(':') != std::string::npos)
      return fail("is no name or address of a host", host, "ports follow from the domain");
    auto address = resolve(host, std::uint16_t{0});
    if (!address) return tl::unexpected(address.error());
    asked.push_back(locator_of(*address));
  }
  for (auto& given : qos.transport().user_transports)
    if (auto* udp = dynamic_cast<transport::UDPv4TransportDescriptor*>(given.get()))
      udp->maxInitialPeersRange = participants_of_a_host;
  return {};
}

}  // namespace

Expected<Address> resolve(const std::string& text, std::optional<std::uint16_t> port) {
  Address address;
  const std::size_t colon = text.rfind(':');
  const std::string host = text.substr(0, colon);
  if (colon != std::string::npos) {
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + colon + 1, end, address.port);
    if (read.ec != std::errc{} || read.ptr != end || address.port == 0)
      return fail("is not ADDRESS:PORT", text, "a port is 1 to 65535");
  } else if (port) {
    address.port = *port;
  } else {
    return fail("names no port", text, "write ADDRESS:PORT");
  }
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  const int code =
      host.empty() ? EAI_NONAME : ::getaddrinfo(host.c_str(), nullptr, &wanted, &found);
  if (code != 0 || !found)
    return fail(fmt::format("does not resolve ({})", ::gai_strerror(code)), text,
                "is the name right, and the network up?");
  const auto* ip = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  std::copy_n(reinterpret_cast<const std::uint8_t*>(&ip->sin_addr), 4, address.ip.begin());
  ::freeaddrinfo(found);
  return address;
}

rtps::GuidPrefix_t server_prefix(std::uint16_t port) {
  rtps::GuidPrefix_t prefix;
  std::copy(first_server.begin(), first_server.end(), prefix.value);
  prefix.value[2] = static_cast<rtps::octet>(port - first_server_port);
  return prefix;
}

rtps::Locator_t locator_of(const Address& address) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = address.port;
  rtps::IPLocator::setIPv4(locator, address.ip[0], address.ip[1], address.ip[2], address.ip[3]);
  return locator;
}

Expected<fdds::DomainParticipantQos> participant_qos(const Network& network,
                                                     const DiscoveryOptions& discovery) {
  isolate_from_environment();
  constexpr std::string_view profiles[] = {"laptop", "lan", "server", "wan"};
  if (std::find(std::begin(profiles), std::end(profiles), network.profile) == std::end(profiles))
    return fail("must be laptop, lan, server or wan, not " + network.profile, "lab.network");
  if (network.profile == "wan" && network.keys.empty() && !network.insecure)
    return fail("would let in whoever reaches this host: there are no keys", "lab.network = wan",
                "set lab.keys, or lab.insecure = true to do without");
  auto qos = load(network.profile);
  if (!qos) return qos;
  if (const std::string wrong = violation(network.profile, *qos); !wrong.empty())
    return fail(wrong, fmt::format("{}.xml", network.profile),
                "deploy/dds/README.md tells what must stay");
  if (const auto up = need_interface(network.profile); !up) return tl::unexpected(up.error());
  // Each participant changes its own: the descriptors are shared otherwise.
  for (auto& given : qos->transport().user_transports) {
    if (const auto* udp = dynamic_cast<transport::UDPv4TransportDescriptor*>(given.get()))
      given = std::make_shared<transport::UDPv4TransportDescriptor>(*udp);
    else if (const auto* tcp = dynamic_cast<transport::TCPv4TransportDescriptor*>(given.get()))
      given = std::make_shared<transport::TCPv4TransportDescriptor>(*tcp);
  }
  if (network.profile == "wan")
    if (const auto joined = join_sites(*qos, network); !joined)
      return tl::unexpected(joined.error());
  if (network.profile == "lan" && !network.hosts.empty())
    if (const auto asked = ask_hosts(*qos, network.hosts); !asked)
      return tl::unexpected(asked.error());
  if (network.profile == "server")
    if (const auto used = use_servers(*qos, network, discovery); !used)
      return tl::unexpected(used.error());
  return qos;
}

bool is_server(const rtps::GuidPrefix_t& prefix) {
  GuidPrefix bytes;
  std::copy_n(prefix.value, bytes.size(), bytes.begin());
  return is_server(bytes);
}

std::vector<Error> environment_overrides() {
  std::vector<Error> found;
  for (const auto& [name, effect] : variables)
    if (const char* value = std::getenv(name))
      found.push_back(
          {fmt::format("{}; it is set to '{}' and has no effect on Prehend", effect, value), name,
           fmt::format("unset {}", name)});
  std::error_code code;
  if (std::filesystem::exists(profiles_file, code))
    found.push_back(
        {"holds profiles that Fast DDS takes as its defaults; it has no effect on Prehend",
         (std::filesystem::current_path(code) / profiles_file).string(),
         "remove the file, or work in another folder"});
  return found;
}

void isolate_from_environment() {
  static std::mutex mutex;
  static bool first = true;
  const std::scoped_lock lock(mutex);
  for (const Error& influence : environment_overrides())
    if (first || std::getenv(influence.where.c_str())) log::warning("{}", influence.message());
  for (const auto& [name, effect] : variables)
    if (std::getenv(name)) ::unsetenv(name);
  if (!std::exchange(first, false)) return;
  ::setenv("SKIP_DEFAULT_XML_FILE", "1", 1);
  DdsLog::install();
}

}  // namespace prehend::dds
