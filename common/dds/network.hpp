#pragma once

#include <array>
#include <cstdint>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// How a process reaches the others. The profiles themselves are XML files of Fast DDS in
/// deploy/dds.
struct Network {
  std::string profile = "laptop";    // laptop, lan, server or wan
  std::vector<std::string> servers;  // server: ADDRESS:PORT of each discovery server
  std::vector<std::string> peers;    // wan: HOST or HOST:PORT to dial; empty: this site listens
  std::string listen;                // wan: HOST:PORT where others dial this process; empty: at
                                     // its own address
  std::vector<std::string> hosts;    // lan: those that multicast does not reach, each asked as well
  std::filesystem::path keys;        // of this process, see security.hpp; empty: not secured
  bool insecure = false;             // wan: may do without keys
};

/// What a participant is to the discovery of a network.
struct DiscoveryOptions {
  bool sees_all = false;  // server: is told of topics that it neither reads nor writes
  std::string serves;     // ADDRESS:PORT at which it is itself the server; empty: it is none
};

/// A place to reach by IPv4.
struct Address {
  std::array<std::uint8_t, 4> ip{};
  std::uint16_t port = 0;
};

/// "HOST:PORT", or "HOST" where a port is given to fall back to. A name is resolved now.
Expected<Address> resolve(const std::string& text, std::optional<std::uint16_t> port = {});

/// Transports and discovery of a participant on this network, with everything else at Fast DDS's
/// defaults. Fast DDS itself goes on without a profile that it cannot read, and without the parts
/// that it does not understand: here both are errors, and so is a profile that is not what its name
/// says.
Expected<eprosima::fastdds::dds::DomainParticipantQos> participant_qos(
    const Network& network, const DiscoveryOptions& discovery = {});

/// Is this the prefix of a discovery server's GUID?
bool is_server(const rtps::GuidPrefix_t& prefix);

/// What in the environment and the working directory would have changed DDS behind our back.
std::vector<Error> environment_overrides();

/// Switches that off, and sends what Fast DDS has to say to our log instead of standard output.
/// Must come before every participant; participant_qos() sees to it.
void isolate_from_environment();

}  // namespace prehend::dds
