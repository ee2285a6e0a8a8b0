#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/dds/network.hpp"

namespace prehend::dds {

/// Makes a participant of the profile wan one end of the TCP connections between sites: it dials
/// network.peers or, where there are none, listens. Around the TCP of Fast DDS 2.9 goes a transport
/// that keeps it from what it does wrong:
/// - Within a site TCP is not used: two processes that dial each other at once both fail.
/// - A process has one logical port for everything. Another that is asked for over a standing
///   connection is lost when the answer comes before the library has noted the question.
/// - A connection that was greeted before the library had noted what to ask for says nothing, for
///   ever: it is cut, and the library dials again.
/// - Who dials is known by its own address and process number, which repeat from container to
///   container: a number drawn at random is added.
/// - A process behind a gateway is reached there, and only once.
/// - With keys, one who calls and says nothing keeps nobody out (TlsFront).
Expected<void> join_sites(eprosima::fastdds::dds::DomainParticipantQos& qos,
                          const Network& network);

/// The places that an entry of lab.peers stands for: HOST:PORT, or every port at which a process of
/// the site HOST may listen.
Expected<std::vector<Address>> dialled(const std::string& peer);

}  // namespace prehend::dds
