#pragma once

#include <map>

#include "common/base/time.hpp"
#include "common/service/config.hpp"
#include "services/cli/tools/doctor/check.hpp"

/// Checks with sockets of our own, beneath DDS.
namespace prehend::cli {

/// Does a multicast datagram that this machine sends reach it? (laptop, lan)
Check check_multicast(const service::Config& config);

/// Listens where participants of every domain announce themselves, and returns how many datagrams
/// of DDS came for each. (laptop, lan)
std::map<int, int> heard_domains(const service::Config& config, Duration listen);

/// That somebody takes the call at each peer that a site dials (lab.peers).
Check check_sites(const service::Config& config);

}  // namespace prehend::cli
