#include "services/mapping/core/features.hpp"

namespace prehend::mapping {

namespace {

constexpr std::array used_fingers{model::Finger::thumb, model::Finger::index,
                                  model::Finger::little};
constexpr double longest = 0.4;  // m

/// Distances of the used fingertips from the origin of H.
Eigen::Vector3d distances(const Features& f) {
  return {f.segment<3>(0).norm(), f.segment<3>(3).norm(), f.segment<3>(6).norm()};
}

Eigen::Vector3d reference(const model::HumanPosture& posture) {
  const auto tips = model::HumanHand(1.0).fingertip_poses(posture);
  Features f;
  for (std::size_t i = 0; i < used_fingers.size(); ++i)
    f.segment<3>(static_cast<Eigen::Index>(3 * i)) =
        tips[static_cast<std::size_t>(used_fingers[i])].translation();
  return distances(f);
}

}  // namespace

Expected<Features> features(const Fingertips& fingertips, double hand_scale) {
  // Written so that not-a-number fails.
  if (!(hand_scale >= 0.5 && hand_scale <= 2.0)) return fail("hand scale out of range");
  Features result;
  for (std::size_t i = 0; i < used_fingers.size(); ++i) {
    const Fingertip& tip = fingertips[static_cast<std::size_t>(used_fingers[i])];
    if (!tip.valid) return fail("fingertip missing");
    if (!tip.p_HF.allFinite()) return fail("fingertip not finite");
    if (tip.p_HF.norm() > longest) return fail("fingertip too far away");
    result.segment<3>(static_cast<Eigen::Index>(3 * i)) = tip.p_HF / hand_scale;
  }
  return result;
}

Eigen::Vector3d bending(const Features& features) {
  static const Eigen::Vector3d open = reference(model::HumanHand::open_posture());
  static const Eigen::Vector3d fist = reference(model::HumanHand::fist_posture());
  return (open - distances(features)).cwiseQuotient(open - fist);
}

}  // namespace prehend::mapping
