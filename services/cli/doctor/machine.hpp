#pragma once

#include <prehend/base/time.hpp>
#include <prehend/service/config.hpp>

#include "finding.hpp"

/// Checks of this machine and this process's settings, without joining the lab.
namespace prehend::cli {

Finding check_environment();
Finding check_profile(const service::Config& config);
Finding check_interface(const service::Config& config);
Finding check_keys(const service::Config& config, Time now);
/// Segments that Fast DDS programs have left behind when they were killed.
Finding check_stale_memory();
/// Shared memory reaches neither into another IPC namespace nor to another user. Our profiles do
/// not use it; programs on this machine that do, and these two, are told.
Finding check_ipc_namespaces();
Finding check_users();
Finding check_programs();
Finding check_devices(const service::Config& config);

}  // namespace prehend::cli
