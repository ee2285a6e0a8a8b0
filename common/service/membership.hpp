#pragma once

#include <prehend/dds/participant.hpp>
#include <string>

#include "config.hpp"

namespace prehend::service {

/// What it takes to join the configured lab under this name.
dds::ParticipantOptions membership(const Config& config, const std::string& name);

}  // namespace prehend::service
