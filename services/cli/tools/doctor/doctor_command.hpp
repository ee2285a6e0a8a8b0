#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend doctor`: what is wrong with this machine's set-up, and the mend.
int doctor_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
