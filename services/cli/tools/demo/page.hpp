#pragma once

#include <string>
#include <vector>

#include "common/stage/stage.hpp"

namespace prehend::cli {

/// Starts the console and says where its page is.
Expected<void> show_page(stage::Stage& stage, const std::vector<std::string>& sets = {});

}  // namespace prehend::cli
