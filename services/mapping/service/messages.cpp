#include "services/mapping/service/messages.hpp"

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

Expected<RobotState> state_from_message(const v1::HandState& message) {
  auto X_WB = convert::from_message(message.X_WB());
  if (!X_WB) return fail("pose of the robot not usable");
  return RobotState{from_ns(message.stamp_ns()), convert::from_message(message.dof()),
                    convert::from_message(message.velocity()),
                    convert::from_message(message.torque()), *X_WB};
}

std::vector<LinkTouch> touch_from_message(const v1::HandTouch& message) {
  std::vector<LinkTouch> links;
  for (const v1::PadTouch& pad : message.pads())
    links.push_back(pad.valid() ? LinkTouch{pad.touching(), pad.pressure(), pad.slipping()}
                                : LinkTouch{});
  return links;
}

v1::GloveFeedback to_message(const model::HandFeedback& feedback) {
  v1::GloveFeedback message;
  for (std::size_t f = 0; f < feedback.size(); ++f) {
    v1::FingerFeedback& finger = message.fingers()[f];
    finger.force(feedback[f].force);
    finger.contact(feedback[f].contact);
    finger.slip(feedback[f].slip);
    finger.limit(feedback[f].limit);
  }
  return message;
}

}  // namespace prehend::mapping
