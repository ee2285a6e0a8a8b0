#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <utility>

#include "common/dds/guard/packet.hpp"
#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// Logical port of who listens and of who dials: it tells them apart.
inline constexpr std::uint16_t listens = 7410, dials = 7412;

/// Places that a process dials, by address and port; none: it listens.
using Dialled = std::set<std::pair<Ipv4, std::uint16_t>>;

/// The same transport, of TCPv4, as one end of the connections between sites. It keeps Fast DDS
/// from what it does wrong there:
/// - Within a site TCP is not used: two processes that dial each other at once both fail.
/// - A connection that was greeted before the library had noted what to ask for says nothing, for
///   ever: it is cut, and the library dials again. Fast DDS 3 does not need that.
/// - A process behind a gateway is reached there, and only once.
/// keeps: lives as long as the transport is used.
std::shared_ptr<transport::TransportDescriptorInterface> wan_transport(
    std::shared_ptr<transport::TransportDescriptorInterface> tcp, Dialled dialled,
    std::shared_ptr<const void> keeps);

}  // namespace prehend::dds
