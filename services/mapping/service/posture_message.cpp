#include "services/mapping/service/posture_message.hpp"

#include "common/convert/convert.hpp"

namespace prehend::mapping {

Expected<Posture> posture_from_message(const v1::HandPosture& message) {
  auto X_WH = convert::from_message(message.X_WH());
  if (!X_WH) return fail("pose of the hand not usable");
  Posture posture{
      from_ns(message.stamp_ns()), from_ns(message.origin_ns()), *X_WH, message.hand_scale(), {}};
  for (std::size_t f = 0; f < posture.fingertips.size(); ++f) {
    const v1::Fingertip& tip = message.fingertips()[f];
    posture.fingertips[f] = {tip.valid(), convert::from_message(tip.p_HF())};
  }
  return posture;
}

}  // namespace prehend::mapping
