#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend stop`: robots obey nothing any more until they are released.
int stop_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
