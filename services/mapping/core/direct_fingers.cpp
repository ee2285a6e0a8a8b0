#include "services/mapping/core/direct_fingers.hpp"

#include <utility>

#include "common/model/human_hand.hpp"

namespace prehend::mapping {

namespace {

/// How much of the fingertips' answer the combined mode takes in the end: what is held by the tips
/// needs them in place, what is wrapped needs the fingers' shape.
double precision_of(GraspType type) {
  switch (type) {
    case GraspType::precision:
      return 1;
    case GraspType::circular_sphere:
      return 0.5;
    case GraspType::power_wrap:
    case GraspType::none:
      break;
  }
  return 0;
}

HumanTips tips_in_grasp_frame(const Fingertips& fingertips, const Pose& X_HG) {
  const Pose X_GH = X_HG.inverse();
  HumanTips p_GT;
  for (std::size_t f = 0; f < fingertips.size(); ++f)
    if (fingertips[f].valid) p_GT[f] = X_GH * fingertips[f].p_HF;
  return p_GT;
}

}  // namespace

Expected<void> DirectFingers::use(FingerMode mode) {
  std::optional<Retargeter> retargeter;
  if (mode != FingerMode::joints) {
    const auto method = mode == FingerMode::retargeting ? Method::vector : Method::cartesian;
    auto made = Retargeter::create(hand_, method);
    if (!made) return tl::unexpected(made.error());
    retargeter.emplace(std::move(*made));
  }
  retargeter_.swap(retargeter);
  mode_ = mode;
  return {};
}

Expected<Eigen::VectorXd> DirectFingers::answer(const Posture& posture,
                                                const Eigen::VectorXd& joints,
                                                const Eigen::VectorXd& before, GraspType grasp,
                                                Duration elapsed) {
  if (!retargeter_) return joints;
  const Pose X_HG = model::HumanHand(posture.hand_scale).X_HG();
  auto fingertips = retargeter_->answer(tips_in_grasp_frame(posture.fingertips, X_HG),
                                        X_HG.inverse().translation(), before);
  if (!fingertips || mode_ != FingerMode::combined) return fingertips;
  precision_.follow(precision_of(grasp), elapsed);
  return joints + precision_.value() * (*fingertips - joints);
}

}  // namespace prehend::mapping
