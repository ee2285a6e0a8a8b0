#include "services/mapping/core/target_selector.hpp"

#include <utility>

#include "common/model/placement.hpp"
#include "services/mapping/core/palm_offset.hpp"

namespace prehend::mapping {

std::optional<GraspTarget> TargetSelector::within_reach(const ObjectTrack& track,
                                                        const model::CandidateBook& planned,
                                                        const Pose& X_WG, bool engaged) const {
  const Detection& detection = track.detection;
  const auto X_OG =
      model::nearest_grasp(detection.shape, detection.X_WO.inverse() * X_WG, hand_.reach());
  if (!X_OG) return std::nullopt;
  const Pose X_WG_grasp = detection.X_WO * *X_OG;
  const double distance = (X_WG_grasp.translation() - X_WG.translation()).norm();
  const double angle = angle_between(X_WG_grasp.linear(), X_WG.linear());
  if (distance > (engaged ? options_.leave : options_.enter) ||
      angle > (engaged ? options_.leave_angle : options_.enter_angle))
    return std::nullopt;
  if (auto candidate = planned.answer(detection.track, detection.shape, *X_OG);
      candidate && model_.traits().closing) {
    const Pose X_OG_planned = candidate->X_OG;
    const Pose X_GR = X_OG_planned.inverse() * candidate->X_OR;
    return GraspTarget{track,        distance, detection.X_WO * X_OG_planned,
                       X_OG_planned, X_GR,     std::move(candidate)};
  }
  const auto known = model_.known_as(detection.shape);
  if (!known) return std::nullopt;
  const Pose X_GR = make_pose(place_for(model_.traits().places, *known, *X_OG));
  return GraspTarget{track, distance, X_WG_grasp, *X_OG, X_GR, std::nullopt};
}

std::optional<GraspTarget> TargetSelector::select(const ObjectTracks& tracks,
                                                  const model::CandidateBook& planned,
                                                  const Pose& X_WG) const {
  std::optional<GraspTarget> nearest, kept;
  for (const auto& [number, track] : tracks.known()) {
    const bool engaged = engaged_ && engaged_->object.detection.track == number;
    auto found = within_reach(track, planned, X_WG, engaged);
    if (!found) continue;
    if (engaged) kept = found;
    if (!nearest || found->distance < nearest->distance) nearest = std::move(found);
  }
  if (!engaged_) return nearest;
  // Another one takes over only after the weight of this one has gone to 0.
  if (kept && nearest->distance < kept->distance - options_.prefer) return std::nullopt;
  return kept;
}

void TargetSelector::update(const std::optional<GraspTarget>& seen, Phase before, Phase now) {
  if (now == Phase::direct)
    engaged_.reset();
  else if (seen && before != Phase::gripping)
    engaged_ = seen;
}

}  // namespace prehend::mapping
