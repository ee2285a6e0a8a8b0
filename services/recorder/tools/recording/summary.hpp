#pragma once

#include <nlohmann/json_fwd.hpp>

#include "common/recording/mcap/reader.hpp"

namespace prehend::recorder {

/// What is in a recording, as `prehend recording info --json` prints it: duration, losses, topics
/// with their types and counts, what is damaged. Strings of a damaged file may be no UTF-8.
nlohmann::ordered_json summary(recording::mcap::Reader& reader);

}  // namespace prehend::recorder
