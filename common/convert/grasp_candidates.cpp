#include "common/convert/grasp_candidates.hpp"

#include "common/convert/convert.hpp"

namespace prehend::convert {

Expected<model::GraspCandidates> from_message(const v2::GraspCandidates& message,
                                              const model::HandModel& hand) {
  // The DoF of another kind may be as many.
  if (message.model().to_string() != hand.name().substr(0, 63))
    return fail("grasp candidates of another hand");
  model::GraspCandidates planned{message.track(),
                                 {from_message(message.shape()), from_message(message.size())},
                                 {},
                                 message.object().to_string()};
  const auto& follow_through = message.follow_through();
  if (!follow_through.empty() && follow_through.size() != message.candidates().size())
    return fail("follow-through of other grasp candidates");
  for (const v1::GraspCandidate& from : message.candidates()) {
    auto X_OG = from_message(from.X_OG());
    auto X_OR = from_message(from.X_OR());
    if (!X_OG || !X_OR) return fail("pose of a grasp candidate not usable");
    planned.candidates.push_back({*X_OG, *X_OR, from_message(from.preshape()),
                                  from_message(from.dof()), from_message(from.closing()),
                                  from.room()});
    if (!follow_through.empty())
      planned.candidates.back().follow_through = follow_through[planned.candidates.size() - 1];
  }
  return planned;
}

}  // namespace prehend::convert
