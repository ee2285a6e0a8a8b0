#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/mapping/tools/judging/benchmark_summary.hpp"

namespace prehend::mapping {

/// One entry of «grasp_benchmark», with the keys that programs rely on.
nlohmann::ordered_json to_json(const ModeSummary& summary);

}  // namespace prehend::mapping
