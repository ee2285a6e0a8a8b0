#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend discovery-server`: by which services find each other where there is no multicast.
int server_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
