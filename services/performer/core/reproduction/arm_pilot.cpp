#include "services/performer/core/reproduction/arm_pilot.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "common/tasks/task_model.hpp"

namespace prehend::performer {

namespace {

constexpr double peak = 1.875;     // of a movement with the least jerk, by its average speed
constexpr double arm_room = 0.02;  // m; its controller slows down and keeps 10 mm by itself
constexpr double more_room = 0.004, more_joint = 0.05;  // m, rad, in thought
constexpr double more_tilt = 0.02;                      // rad, than it has in the hand
constexpr double hand_room = 0.01;                      // m
constexpr int max_iterations = 400;                     // about a tenth of a second

}  // namespace

Pilot pilot_of(const planning::Robot& robot, std::map<std::string, model::Shape> shapes,
               std::map<std::string, Pose> places, const PilotOptions& how) {
  planning::PlanOptions options;
  options.room.clearance = arm_room;
  options.room.hand_clearance = hand_room;
  options.search.max_iterations = max_iterations;
  options.pace.hand = peak * how.speed;
  options.pace.turn = peak * how.turn_speed;
  if (how.careful) {
    options.room.clearance += more_room;
    options.room.hand_clearance += more_room;
    options.contact_clearance += more_room;
    options.arm_contact_clearance += more_room;
    options.room.joint_margin = more_joint;
  }
  return [=, shapes = std::move(shapes),
          places = std::move(places)](const Journey& journey) -> Expected<Way> {
    planning::Query query;
    query.start = journey.from;
    query.X_WB = journey.X_WB;
    query.then = journey.then;
    query.touched = journey.object;
    query.scene.dof = journey.dof;
    for (const auto& [name, shape] : shapes) {
      const auto place = places.find(name);
      if (name != journey.object && place != places.end())
        query.scene.obstacles.push_back({{name, shape}, place->second});
      else if (name == journey.object && !journey.held)
        query.scene.obstacles.push_back({{name, shape}, journey.X_WO});
      else if (name == journey.object)
        query.scene.held =
            planning::Held{{name, shape}, robot.hand_at(journey.from).inverse() * journey.X_WO};
    }
    if (journey.held && journey.upright) {
      planning::Upright upright{query.scene.held->X_BO.linear().col(2)};
      upright.max_tilt = std::max(upright.max_tilt, tasks::tilt(journey.X_WO) + more_tilt);
      query.upright = upright;
    }
    auto planned = planning::plan(robot, query, options);
    if (!planned) return tl::unexpected(planned.error());
    const double duration = planned->duration();
    const auto joints = std::make_shared<const planning::Trajectory>(std::move(*planned));
    return Way([robot, joints](double t) { return robot.hand_at(joints->at(t)); }, duration);
  };
}

}  // namespace prehend::performer
