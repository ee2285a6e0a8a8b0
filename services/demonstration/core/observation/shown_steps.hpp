#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "services/demonstration/core/segmentation/segmenter.hpp"
#include "services/demonstration/core/tasks/learn_task.hpp"

namespace prehend::demonstration {

/// Where an object was seen, by time, s.
using Sightings = std::vector<std::pair<double, Pose>>;

/// All that was seen of a demonstration.
struct Seen {
  std::vector<SceneSample> scene;    // at an even rate
  std::vector<Pose> X_WG;            // the hand's grasp frame, at each of these
  std::vector<std::string> kinds;    // of grasp, at each of these; empty: unknown
  std::vector<std::string> objects;  // names, as scene numbers them
  std::vector<Sightings> sightings;  // of each object
};

struct StepOptions {
  double min_way = 0.02;  // m: an object that moves less was only touched
  double average = 0.5;   // s, over which the place of an object at rest is taken
};

/// What was taken and put down, in order. An object that cannot be seen moves with the hand that
/// holds it. Fails, naming the object, where it is held at the end, was never seen before it was
/// held or is not seen again, and where nothing was moved.
Expected<tasks::ShownTask> shown_steps(const Seen& seen, const std::vector<Segment>& segments,
                                       const StepOptions& options = {});

}  // namespace prehend::demonstration
