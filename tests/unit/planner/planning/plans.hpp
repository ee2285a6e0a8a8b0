#pragma once

#include <string>

#include "common/grasping/planner.hpp"

namespace prehend::planner {

inline const grasping::Body talc{
    "Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};

/// plan_grasps() in that many threads.
grasping::Plan plan(const std::string& hand, const grasping::Body& object,
                    const grasping::PlanOptions& options, unsigned threads = 2);

/// One plan of Barrett on the Talc, made once.
const grasping::Plan& barrett_on_talc();

}  // namespace prehend::planner
