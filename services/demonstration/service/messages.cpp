#include "services/demonstration/service/messages.hpp"

#include <algorithm>

#include "common/convert/convert.hpp"

namespace prehend::demonstration {

namespace {

constexpr std::size_t max_kinds = 64, max_steps = 64;  // in a message

v1::HandPhase to_message(Phase phase) {
  switch (phase) {
    case Phase::approach:
      return v1::PHASE_APPROACH;
    case Phase::close:
      return v1::PHASE_CLOSE;
    case Phase::hold:
      return v1::PHASE_HOLD;
    case Phase::release:
      return v1::PHASE_RELEASE;
    case Phase::retract:
      return v1::PHASE_RETRACT;
    case Phase::rest:
      break;
  }
  return v1::PHASE_REST;
}

v1::TaskStep to_message(const tasks::Step& step) {
  v1::TaskStep made;
  made.object(step.object);
  made.grasp(step.grasp);
  made.X_OG(convert::to_message(step.X_OG));
  made.reference(step.reference);
  made.X_RO(convert::to_message(step.X_RO));
  made.spread(step.spread);
  made.via_height(step.via_height);
  made.upright(step.upright);
  for (const std::size_t before : step.after)
    if (made.after().size() < max_steps) made.after().push_back(static_cast<std::uint32_t>(before));
  return made;
}

}  // namespace

Expected<SeenHand> hand_from_message(const v1::HandPosture& message) {
  const auto X_WH = convert::from_message(message.X_WH());
  if (!X_WH) return fail("pose of the hand not usable");
  SeenHand made{from_ns(message.stamp_ns()), *X_WH, message.hand_scale(), {}};
  for (std::size_t f = 0; f < made.p_HF.size(); ++f) {
    const v1::Fingertip& tip = message.fingertips()[f];
    const Eigen::Vector3d p_HF = convert::from_message(tip.p_HF());
    if (tip.valid() && p_HF.allFinite()) made.p_HF[f] = p_HF;
  }
  return made;
}

Expected<SeenObject> object_from_message(const v1::ObjectDetection& message) {
  const auto X_WO = convert::from_message(message.X_WO());
  if (!X_WO) return fail("pose of a detection not usable");
  return SeenObject{from_ns(message.stamp_ns()),
                    message.name().to_string(),
                    {convert::from_message(message.shape()), convert::from_message(message.size())},
                    *X_WO};
}

v1::DemonstratedGrasp to_message(const std::vector<std::string>& kinds, const Distribution& p,
                                 double min_probability) {
  v1::DemonstratedGrasp made;
  for (std::size_t k = 0; k < std::min(kinds.size(), max_kinds); ++k) {
    v1::GraspProbability each;
    each.grasp(kinds[k]);
    each.probability(p[static_cast<Eigen::Index>(k)]);
    made.grasps().push_back(each);
  }
  if (const Decision decision = decide(p, min_probability); decision.best)
    made.grasp(kinds[static_cast<std::size_t>(*decision.best)]);
  return made;
}

v1::DemonstratedSegment to_message(const TimedSegment& segment) {
  v1::DemonstratedSegment made;
  made.phase(to_message(segment.phase));
  made.begin_ns(to_ns(segment.begin));
  made.end_ns(to_ns(segment.end));
  made.object(segment.object);
  return made;
}

v1::TaskModel to_message(const tasks::TaskModel& task) {
  v1::TaskModel made;
  made.task(task.name);
  made.demonstrations(static_cast<std::uint32_t>(task.demonstrations));
  for (const tasks::Step& step : task.steps)
    if (made.steps().size() < max_steps) made.steps().push_back(to_message(step));
  return made;
}

}  // namespace prehend::demonstration
