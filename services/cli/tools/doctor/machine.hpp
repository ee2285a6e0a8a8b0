#pragma once

#include "common/base/time.hpp"
#include "common/service/config.hpp"
#include "services/cli/tools/doctor/check.hpp"

/// Checks of this machine and this process's settings, without joining the lab.
namespace prehend::cli {

Check check_environment();
Check check_profile(const service::Config& config);
Check check_interface(const service::Config& config);
Check check_keys(const service::Config& config, Time now);
/// Who moves only while somebody holds the deadman.
Check check_consent(const service::Config& config);
/// Segments that Fast DDS programs have left behind when they were killed.
Check check_stale_memory();
/// Shared memory reaches neither into another IPC namespace nor to another user. Our profiles do
/// not use it; programs on this machine that do, and these two, are told.
Check check_ipc_namespaces();
Check check_users();
Check check_programs();
Check check_devices(const service::Config& config);

}  // namespace prehend::cli
