#pragma once

#include "common/tasks/task_model.hpp"
#include "idl/Demonstration.h"
#include "idl/Glove.h"
#include "idl/Perception.h"
#include "services/demonstration/core/observation/watcher.hpp"
#include "services/demonstration/core/recognition/distribution.hpp"

namespace prehend::demonstration {

/// A hand/posture and an object/detection as they are watched; fail on a pose that is none.
Expected<SeenHand> hand_from_message(const v1::HandPosture& message);
Expected<SeenObject> object_from_message(const v1::ObjectDetection& message);

v1::DemonstratedGrasp to_message(const std::vector<std::string>& kinds, const Distribution& p,
                                 double min_probability);
v1::DemonstratedSegment to_message(const TimedSegment& segment);
v1::TaskModel to_message(const tasks::TaskModel& task);

}  // namespace prehend::demonstration
