#include "tests/integration/shown_hand.hpp"

#include "common/convert/convert.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {

v1::HandPosture shown_hand(const Closure& closure, std::uint64_t frame) {
  v1::HandPosture message;
  message.glove("glove");
  message.sequence_number(frame);
  message.stamp_ns(now_ns());
  message.origin_ns(message.stamp_ns());
  message.hand_scale(1);
  message.quality(1);
  message.X_WH(convert::to_message(make_pose({0, 0, 0.4})));
  const auto tips = model::HumanHand(1).fingertip_poses(model::HumanHand::posture(closure));
  for (std::size_t f = 0; f < tips.size(); ++f) {
    message.fingertips()[f].valid(true);
    message.fingertips()[f].p_HF(convert::to_message(Eigen::Vector3d(tips[f].translation())));
  }
  return message;
}

}  // namespace prehend::integration
