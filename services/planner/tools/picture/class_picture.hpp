#pragma once

#include "common/model/grasp_taxonomy.hpp"
#include "services/planner/tools/picture/drawing.hpp"

namespace prehend::planner {

/// Paints of a class's picture.
inline constexpr int class_hand = 0, class_object = 1;

/// A human hand, palm up, about an object of the class's first shape and of usual width: fingers
/// that take part close on it, the others are stretched, or bent away where they would be in the
/// way. It shows which fingers oppose what; it is no grasp that was measured.
Drawing draw_class(const model::GraspClass& kind);

/// Of all of it, from before the fingers.
Viewpoint view_of_class(const Drawing& drawing, double aspect);

}  // namespace prehend::planner
