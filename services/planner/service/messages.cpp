#include "services/planner/service/messages.hpp"

#include <algorithm>

#include "common/convert/convert.hpp"

namespace prehend::planner {
namespace {

constexpr std::size_t max_candidates = 16;  // of the message

/// What a person would call it: from above a precision grasp where something that closes rests.
v1::GraspType type_of(const grasping::SureGrasp& grasp, const model::HandModel& hand) {
  if (!grasping::is_from_above(grasp.X_OG)) return v1::GRASP_POWER_WRAP;
  for (std::size_t i = 0; i < hand.dofs().size(); ++i)
    if (hand.dofs()[i].closing != 0 && grasp.grasp.closing[static_cast<Eigen::Index>(i)] == 0)
      return v1::GRASP_PRECISION;
  return v1::GRASP_CIRCULAR_SPHERE;
}

v1::GraspCandidate to_message(const grasping::SureGrasp& grasp, const model::HandModel& hand) {
  v1::GraspCandidate message;
  message.X_OG(convert::to_message(grasp.X_OG));
  message.X_OR(convert::to_message(grasp.grasp.X_OG));
  message.preshape(convert::to_message(grasp.grasp.open));
  message.dof(convert::to_message(grasp.grasp.dof));
  message.closing(convert::to_message(grasp.grasp.closing));
  message.grasp_type(type_of(grasp, hand));
  message.epsilon(grasp.grasp.epsilon);
  message.room(grasp.room);
  return message;
}

}  // namespace

v2::GraspCandidates to_message(const TrackPlan& planned, const std::string& hand_name,
                               const model::HandModel& hand) {
  v2::GraspCandidates message;
  message.hand(hand_name);
  message.track(planned.seen.track);
  message.stamp_ns(to_ns(planned.seen.stamp));
  message.model(hand.name().substr(0, 63));
  message.object(planned.seen.name.substr(0, 63));
  message.shape(convert::to_message(planned.plan.object.shape.kind));
  message.size(convert::to_message(planned.plan.object.shape.size));
  message.mass(planned.plan.object.mass);
  message.complete(planned.plan.complete);
  message.reason(planned.plan.reason.substr(0, 254));
  const std::size_t count = std::min(planned.plan.grasps.size(), max_candidates);
  for (std::size_t i = 0; i < count; ++i) {
    message.candidates().push_back(to_message(planned.plan.grasps[i], hand));
    message.follow_through().push_back(planned.plan.grasps[i].follow_through);
  }
  return message;
}

}  // namespace prehend::planner
