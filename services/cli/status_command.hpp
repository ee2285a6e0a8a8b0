#pragma once

#include <prehend/idl/Operation.h>

#include <map>
#include <string>
#include <vector>

namespace prehend::cli {

/// The JSON document of `prehend status --json`.
std::string status_json(const std::map<std::string, v1::ServiceStatus>& services);
/// The same for people.
std::string status_table(const std::map<std::string, v1::ServiceStatus>& services);

/// `prehend status`. Returns the exit code.
int status_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
