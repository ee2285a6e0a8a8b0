#pragma once

#include <string>

#include "common/dds/participant.hpp"
#include "common/service/config.hpp"

namespace prehend::service {

/// What it takes to join the configured lab under this name. role: what it is, and whose keys it
/// takes where lab.keys holds those of all; empty: that of its name.
dds::ParticipantOptions membership(const Config& config, const std::string& name,
                                   const std::string& role = {});

}  // namespace prehend::service
