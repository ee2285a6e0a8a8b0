#pragma once

#include "common/base/error.hpp"
#include "common/gate/motion_limiter.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/world.hpp"
#include "idl/Perception.h"
#include "idl/Robot.h"
#include "idl/World.h"
#include "services/simulation/core/closure.hpp"
#include "services/simulation/core/command.hpp"
#include "services/simulation/core/touch_sense.hpp"

/// Between the topics and the values of the core.
namespace prehend::simulation {

/// place: what the gate has left of it.
Command from_message(const v2::HandCommand& message, const gate::Place& place);

/// An object as it was seen. What the catalogue knows is taken from there, except the size, which
/// was seen; anything else is taken for a light thing of wood.
struct Sighting {
  grasping::Body body;
  Pose X_WO;
};
Expected<Sighting> from_message(const v1::ObjectDetection& message,
                                const grasping::CatalogueBodies& catalogue);

v1::HandState to_message(const grasping::HandMotion& motion);
v1::HandTouch to_message(const std::vector<PadTouch>& pads, const model::HandModel& hand);
v1::ObjectState to_message(const grasping::Body& body, const grasping::BodyMotion& motion);
v1::BodyDescription to_message(const grasping::Body& body);
/// hands: their names, by their numbers in the world.
v1::GraspReport to_message(const Closure& closure, const GraspVerdict& verdict,
                           const std::vector<std::string>& hands);

}  // namespace prehend::simulation
