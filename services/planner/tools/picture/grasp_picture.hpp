#pragma once

#include <filesystem>

#include "common/base/error.hpp"
#include "common/grasping/planner.hpp"
#include "common/model/hand_model.hpp"
#include "services/planner/tools/picture/drawing.hpp"

namespace prehend::planner {

/// What the surfaces of the picture are, beside one paint a material.
struct GraspDrawing {
  Drawing drawing;
  std::vector<int> hand_paints;  // of the hand's links
  int object_paint = 0, cone_paint = 0, touch_paint = 0;
};

/// The hand in its closed posture, the object, which one can see through, and each contact with
/// its friction cone, in the object's frame. Fails when the grasp is not one of this hand.
Expected<GraspDrawing> draw_grasp(const model::HandModel& hand, const grasping::Body& object,
                                  const grasping::PlannedGrasp& grasp);

/// The hand alone in a posture (values of its DoFs). W: its palm looks along x, and its fingers
/// close along y.
Drawing draw_hand(const model::HandModel& hand, const Eigen::VectorXd& dof);

/// From that direction (unit, not straight up), so near that all of it just fills the picture.
Viewpoint look_at(const Drawing& drawing, const Eigen::Vector3d& from, double aspect);

/// The view, of many around the object, that shows most of the object and the contacts.
Viewpoint best_view(const GraspDrawing& scene, double aspect);

/// As PNG or JPEG, by the ending of the name.
Expected<void> save(const std::filesystem::path& file, const Raster& raster);

}  // namespace prehend::planner
