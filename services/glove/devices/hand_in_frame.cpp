#include "services/glove/devices/hand_in_frame.hpp"

#include "services/glove/core/fingers_from_tips.hpp"

namespace prehend::glove {

std::optional<HandInFrame> hand_in(const Frame& frame, const model::HumanHand& hand,
                                   const model::HumanPosture& before) {
  std::optional<Pose> X_TH;
  for (const Reading& reading : frame.readings)
    if (reading.site == Site::back_of_hand && reading.q_TS.norm() > 1e-6)
      X_TH = make_pose(reading.p_TS, reading.q_TS.normalized());
  if (!X_TH) return std::nullopt;
  if (frame.joint_angles.size() == static_cast<std::size_t>(model::human_dof_count))
    return HandInFrame{
        *X_TH, hand.clamp(Eigen::Map<const model::HumanPosture>(frame.joint_angles.data()))};
  std::array<std::optional<Eigen::Vector3d>, model::finger_count> p_HF;
  for (const Reading& reading : frame.readings)
    if (const auto finger = finger_of(reading.site))
      p_HF[static_cast<std::size_t>(*finger)] = X_TH->inverse() * reading.p_TS;
  return HandInFrame{*X_TH, fingers_from_tips(hand, p_HF, before)};
}

}  // namespace prehend::glove
