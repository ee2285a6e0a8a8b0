#include "services/mapping/tools/benchmark/lab_messages.hpp"

#include <algorithm>

#include "common/convert/convert.hpp"
#include "common/convert/detection.hpp"
#include "services/mapping/service/messages.hpp"
#include "services/mapping/tools/judging/answerer.hpp"

namespace prehend::mapping {

v1::HandPosture to_message(const Posture& posture, const std::string& user) {
  v1::HandPosture message;
  message.glove("take");
  message.stamp_ns(to_ns(posture.stamp));
  message.origin_ns(to_ns(posture.origin));
  message.user(user.substr(0, 64));
  message.hand_scale(posture.hand_scale);
  message.quality(1);
  message.X_WH(convert::to_message(posture.X_WH));
  for (std::size_t f = 0; f < posture.fingertips.size(); ++f) {
    message.fingertips()[f].valid(posture.fingertips[f].valid);
    message.fingertips()[f].p_HF(convert::to_message(posture.fingertips[f].p_HF));
  }
  return message;
}

v1::ObjectDetection to_message(const Detection& detection) {
  v1::ObjectDetection message;
  message.track(detection.track);
  message.stamp_ns(to_ns(detection.stamp));
  message.name(detection.name);
  message.shape(convert::to_message(detection.shape.kind));
  message.size(convert::to_message(detection.shape.size));
  message.X_WO(convert::to_message(detection.X_WO));
  std::copy_n(detection.covariance.data(), 16, message.covariance().begin());
  message.probability(detection.probability);
  return message;
}

v1::HandState to_message(const RobotState& state, const std::string& model) {
  v1::HandState message;
  message.hand(benchmarked_hand_name);
  message.stamp_ns(to_ns(state.stamp));
  message.model(model);
  message.dof(convert::to_message(state.dof));
  message.velocity(convert::to_message(state.velocity));
  message.torque(convert::to_message(state.torque));
  message.X_WB(convert::to_message(state.X_WB));
  return message;
}

Pose as_read(const Pose& X) {
  return convert::from_message(convert::to_message(X)).value_or(X);
}

Posture as_read(const Posture& posture) {
  return posture_from_message(to_message(posture, "")).value_or(posture);
}

Detection as_read(const Detection& detection) {
  return convert::from_message(to_message(detection)).value_or(detection);
}

RobotState as_read(const RobotState& state) {
  return state_from_message(to_message(state, "")).value_or(state);
}

}  // namespace prehend::mapping
