#pragma once

#include "common/service/config.hpp"
#include "services/ros/service/teller.hpp"

namespace prehend::ros {

/// Tells nodes of ROS 2 what the lab does, until SIGTERM or Ctrl-C. Returns the exit code.
int tell_nodes(const service::Config& config, const Teller::Options& options);

}  // namespace prehend::ros
