#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend keys init|add|revoke|show`: the keys with which the lab's processes know each other.
int keys_command(const std::vector<std::string>& texts);

}  // namespace prehend::cli
