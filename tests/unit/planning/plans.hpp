#pragma once

#include <prehend/grasping/planner.hpp>
#include <prehend/model/hand_model.hpp>
#include <string>

namespace prehend::simulation {

/// A hand of the source tree, loaded once.
const model::HandModel& hand_called(const std::string& name);

/// The folders of common/models/hands.
std::vector<std::string> all_hands();

inline const grasping::Body talc{
    "Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};

/// plan_grasps() in that many threads.
grasping::Plan plan(const std::string& hand, const grasping::Body& object,
                    const grasping::PlanOptions& options, unsigned threads = 2);

/// One plan of Barrett on the Talc, made once.
const grasping::Plan& barrett_on_talc();

}  // namespace prehend::simulation
