#pragma once

#include <array>
#include <filesystem>

#include "common/base/error.hpp"
#include "services/recognition/tools/trials/trials.hpp"

namespace prehend::recognition {

/// What would be reported if a probability of `threshold` were enough.
struct RocPoint {
  double detected = 0;  // share of the targets
  double alarms = 0;    // share of the frames that show a false alarm
};
RocPoint roc_at(double threshold, const std::vector<TrialResult>& results);

/// Thresholds that tables and the picture name.
inline constexpr std::array roc_thresholds{0.05, 0.1, 0.2, 0.3,  0.5, 0.6,
                                           0.7,  0.8, 0.9, 0.95, 0.99};

/// Targets detected against frames with a false alarm, over all thresholds, as a png (by gnuplot).
Expected<void> draw_roc(const std::vector<TrialResult>& results, const std::filesystem::path& png);

}  // namespace prehend::recognition
