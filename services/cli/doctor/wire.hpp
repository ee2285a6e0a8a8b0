#pragma once

#include <map>
#include <prehend/base/time.hpp>
#include <prehend/service/config.hpp>

#include "finding.hpp"

/// Checks with sockets of our own, beneath DDS.
namespace prehend::cli {

/// Does a multicast datagram that this machine sends reach it? (laptop, lan)
Finding check_multicast(const service::Config& config);

/// Listens where participants of every domain announce themselves, and returns how many datagrams
/// of DDS came for each. (laptop, lan)
std::map<int, int> heard_domains(const service::Config& config, Duration listen);

/// That somebody takes the call at each peer that a site dials (lab.peers).
Finding check_sites(const service::Config& config);

}  // namespace prehend::cli
