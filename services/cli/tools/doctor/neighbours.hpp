#pragma once

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/service/config.hpp"
#include "services/cli/tools/doctor/check.hpp"

namespace prehend::cli {

/// Joins the lab only to look, for as long as it takes to hear everyone's status twice, and checks
/// the discovery server, domain, rig, types, shared memory, security, clocks of other hosts, and
/// which glove leads which hand.
Expected<Findings> check_neighbours(const service::Config& config, Duration listen);

}  // namespace prehend::cli
