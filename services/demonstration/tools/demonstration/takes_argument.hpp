#pragma once

#include <string>

#include "common/base/error.hpp"
#include "services/demonstration/files/takes_file.hpp"

namespace prehend::demonstration {

/// The takes of a folder; says what was wrong with its files, one line each.
Expected<Takes> told_takes(const std::string& folder);

}  // namespace prehend::demonstration
