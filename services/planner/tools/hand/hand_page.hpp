#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/planner.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::planner {

/// An object that was tried, and the best grasp of it; none: no hand closed on it.
struct Trial {
  grasping::Body object;
  std::optional<grasping::PlannedGrasp> best;
};

/// Writes into the hand's folder what was understood of it, for people: hand.html, and in pictures/
/// a PNG of each posture and of each trial. report: the JSON of `hand add`.
Expected<void> write_page(const std::filesystem::path& folder, const model::HandModel& hand,
                          const std::vector<Trial>& trials, const nlohmann::ordered_json& report);

}  // namespace prehend::planner
