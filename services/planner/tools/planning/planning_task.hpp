#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/planner.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/catalogue_argument.hpp"

namespace prehend::planner {

/// A hand of the lab by name, or of the folder of that path. The error lists those that there are.
Expected<model::HandModel> find_hand(const std::string& name);

/// The objects of these names, or without any all of the catalogue, as bodies. The error lists
/// those that there are.
Expected<std::vector<grasping::Body>> catalogue_bodies(const service::CatalogueArgument& catalogue,
                                                       const std::vector<std::string>& names = {});
Expected<grasping::Body> find_body(const service::CatalogueArgument& catalogue,
                                   const std::string& name);

/// plan_grasps() in so many threads (0: one a core), with progress on standard error.
Expected<grasping::Plan> plan_with_progress(const model::HandModel& hand,
                                            const grasping::Body& object,
                                            const grasping::PlanOptions& options, unsigned threads);

/// Plans with a few candidates at a time, up to so many, until a grasp has held: most hands hold
/// most things within the first. A hand of few DoFs closes in no time and may have up to four times
/// as many: of its candidates few touch an object twice, and fewer near its middle. For hands whose
/// postures were searched, so that most candidates keep to them. The last plan, or the one in which
/// most candidates closed.
Expected<grasping::Plan> plan_in_batches(const model::HandModel& hand, const grasping::Body& object,
                                         int candidates, unsigned threads);

/// «lift, shake, turn» as far as it was survived, or «no: » and why.
std::string describe(const grasping::HoldResult& hold);

}  // namespace prehend::planner
