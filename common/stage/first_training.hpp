#pragma once

#include <functional>
#include <string>

#include "common/base/error.hpp"

namespace prehend::stage {

/// Lets prehend-train make the mapping model of a hand, a name or a folder, where there is none
/// that fits the hand as it is now. It says itself how that goes. Waits until it has ended; fails
/// without words as soon as `stopped` is true.
Expected<void> train_if_needed(
    const std::string& hand, const std::function<bool()>& stopped = [] { return false; });

}  // namespace prehend::stage
