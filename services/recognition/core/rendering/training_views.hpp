#pragma once

#include <cstdint>

#include "services/recognition/core/learning/training.hpp"
#include "services/recognition/core/rendering/renderer.hpp"

namespace prehend::recognition {

/// Rendered pictures of one object by itself for training, each under another light, from another
/// side, before another background. They are as large in pixels as the object is in `lab`'s
/// picture, give or take a quarter, but seen from other places and on tables of other colours, so
/// that nothing of a scene on the lab's table is known beforehand.
std::vector<TrainingView> training_views(const Renderer& renderer,
                                         const model::CatalogueObject& object,
                                         const CameraModel& lab, int views, std::uint64_t seed);

}  // namespace prehend::recognition
