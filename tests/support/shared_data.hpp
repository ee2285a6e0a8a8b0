#pragma once

#include <cstdlib>
#include <filesystem>

#include "tests/support/paths/paths.hpp"

namespace prehend {

/// The folder of real data, which is not part of the sources: PREHEND_SHARED_DATA, otherwise
/// shared/data beside the clone. A test that finds nothing there skips and says what it misses;
/// what it guards is tested on made data besides.
inline std::filesystem::path shared_data() {
  const char* given = std::getenv("PREHEND_SHARED_DATA");
  return given ? given : test::in_sources("../shared/data");
}

}  // namespace prehend
