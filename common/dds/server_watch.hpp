#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/network.hpp"
#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// The port at which linked discovery servers begin to count: server n listens at 11811 + n.
inline constexpr std::uint16_t first_server_port = 11811;
/// Clients know a server by this prefix, which is that of `fast-discovery-server -i N`.
rtps::GuidPrefix_t server_prefix(std::uint16_t port);
/// Where it is reached by UDP.
rtps::Locator_t locator_of(const Address& address);

/// Makes a participant with this QoS a client of the server there.
void add_server(fdds::DomainParticipantQos& qos, const Address& address);
/// Adds this place of a server that is known by its port; false: it is known there, or not at all.
bool add_place(fdds::DomainParticipantQos& qos, const Address& address);
/// Of the servers whose client it is: where they are reached.
std::vector<rtps::Locator_t> servers_of(const fdds::DomainParticipantQos& qos);

/// Looks every two seconds where the names of discovery servers lead to: a container that is
/// started again comes back at another address.
class ServerWatch {
 public:
  /// is_at: told of the address of each server that has a name, in a thread of its own. Addresses
  /// in numbers are not looked up.
  ServerWatch(const std::vector<std::string>& servers, std::function<void(const Address&)> is_at);

 private:
  void watch(const std::stop_token& stop);

  std::vector<std::string> names_;
  std::function<void(const Address&)> is_at_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace prehend::dds
