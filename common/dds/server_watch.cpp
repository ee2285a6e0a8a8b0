#include "common/dds/server_watch.hpp"

#include <arpa/inet.h>

#include <algorithm>

namespace prehend::dds {

#if PREHEND_FAST_DDS == 2

void add_server(fdds::DomainParticipantQos& qos, const Address& address) {
  transport::RemoteServerAttributes server;
  server.guidPrefix = server_prefix(address.port);
  server.metatrafficUnicastLocatorList.push_back(locator_of(address));
  qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers.push_back(server);
}

bool add_place(fdds::DomainParticipantQos& qos, const Address& address) {
  const auto locator = locator_of(address);
  for (auto& server : qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers) {
    auto& known = server.metatrafficUnicastLocatorList;
    if (server.guidPrefix != server_prefix(address.port) ||
        std::find(known.begin(), known.end(), locator) != known.end())
      continue;
    known.push_back(locator);
    return true;
  }
  return false;
}

std::vector<rtps::Locator_t> servers_of(const fdds::DomainParticipantQos& qos) {
  std::vector<rtps::Locator_t> all;
  for (const auto& server : qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers)
    for (const auto& locator : server.metatrafficUnicastLocatorList) all.push_back(locator);
  return all;
}

#else

// To Fast DDS 3 servers are no more than their addresses. Ours are told apart by the port.
void add_server(fdds::DomainParticipantQos& qos, const Address& address) {
  qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers.push_back(locator_of(address));
}

bool add_place(fdds::DomainParticipantQos& qos, const Address& address) {
  const auto all = servers_of(qos);
  const auto locator = locator_of(address);
  if (std::ranges::find(all, locator) != all.end() ||
      std::ranges::find(all, locator.port, &rtps::Locator_t::port) == all.end())
    return false;
  add_server(qos, address);
  return true;
}

std::vector<rtps::Locator_t> servers_of(const fdds::DomainParticipantQos& qos) {
  const auto& all = qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers;
  return {all.begin(), all.end()};
}

#endif

ServerWatch::ServerWatch(const std::vector<std::string>& servers,
                         std::function<void(const Address&)> is_at)
    : is_at_(std::move(is_at)) {
  std::copy_if(servers.begin(), servers.end(), std::back_inserter(names_), [](const auto& text) {
    in_addr number{};
    return ::inet_pton(AF_INET, text.substr(0, text.rfind(':')).c_str(), &number) != 1;
  });
  if (!names_.empty()) thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

void ServerWatch::watch(const std::stop_token& stop) {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, stop, std::chrono::seconds(2), [] { return false; });
      if (stop.stop_requested()) return;
    }
    for (const std::string& name : names_)
      if (const auto address = resolve(name, first_server_port)) is_at_(*address);
  }
}

}  // namespace prehend::dds
