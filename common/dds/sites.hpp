#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/dds/network.hpp"

namespace prehend::dds {

/// Makes a participant of the profile wan one end of the TCP connections between sites: it dials
/// network.peers or, where there are none, listens. What Fast DDS does wrong there is kept from it
/// by its transport (guard/wan_transport.hpp), by the front of a listening site with keys
/// (guard/tls_front.hpp), and by what is announced:
/// - A process has one logical port for everything. Another that is asked for over a standing
///   connection is lost when the answer comes before the library has noted the question.
/// - Who dials is known by its own address and process number, which repeat from container to
///   container: a number drawn at random is added.
Expected<void> join_sites(eprosima::fastdds::dds::DomainParticipantQos& qos,
                          const Network& network);

/// The places that an entry of lab.peers stands for: HOST:PORT, or every port at which a process of
/// the site HOST may listen.
Expected<std::vector<Address>> dialled(const std::string& peer);

}  // namespace prehend::dds
