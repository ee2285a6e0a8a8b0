#pragma once

#include <optional>

#include "common/model/scene.hpp"

namespace prehend::model {

/// How a synthetic person grasps a standing object, X_OG: high boxes from above across their depth,
/// with the fingers on the far side; all else from where they come. None if no hand can.
std::optional<Pose> human_grasp(const Shape& shape, const Pose& X_WO, const Demonstrator& person);

}  // namespace prehend::model
