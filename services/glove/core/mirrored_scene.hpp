#pragma once

#include "common/model/scene.hpp"

namespace prehend::glove {

/// The scene in the mirror of left_to_right(), through the tracker's origin: what a left hand does
/// here, a right one does there. Of the demonstrator only where the target is approached and
/// carried is mirrored, since the rest is told in the hand's own frame.
model::Scene mirrored(model::Scene scene, const Pose& X_WT);

}  // namespace prehend::glove
