#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend consent`: holds the deadman of a robot hand, while a key is held, a process lives, or
/// for a time.
int consent_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
