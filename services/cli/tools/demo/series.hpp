#pragma once

#include "common/stage/stage.hpp"
#include "services/cli/tools/demo/options.hpp"

namespace prehend::cli {

/// Several seeds, one after the other.
struct SeriesOptions {
  std::uint64_t first = 1, last = 1;  // seeds, both included
  bool compare_direct = false;        // each once more with direct mapping
  bool json = false;                  // a line a demonstration, then one with the summary
};

/// Runs them and prints a table. Exit code 0 when the object was right in at least 95 % and held in
/// at least 80 % of the demonstrations (direct ones are for comparison only).
int run_series(const DemoOptions& demo, const SeriesOptions& options,
               const stage::Progress& progress);

}  // namespace prehend::cli
