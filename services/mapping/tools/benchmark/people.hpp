#pragma once

#include <filesystem>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/tools/judging/real_take.hpp"

namespace prehend::mapping {

/// Recordings of right hands in a folder, by name: of a Leap or of 21 landmarks (csv), and of the
/// lab (mcap with hand/posture, as of `prehend record` while somebody teaches). What is none is
/// left out. Fails where there is none at all.
Expected<std::vector<RealTake>> load_people(const std::filesystem::path& folder);

}  // namespace prehend::mapping
