#include "services/glove/service/messages.hpp"

#include <cmath>

#include "common/convert/convert.hpp"

namespace prehend::glove {

v1::GloveFrame to_message(const Frame& frame, const std::string& glove, const std::string& device) {
  v1::GloveFrame message;
  message.glove(glove);
  message.sequence_number(frame.sequence);
  message.stamp_ns(to_ns(frame.stamp));
  message.left(frame.left);
  message.device(device);
  message.joint_angles(frame.joint_angles);
  for (const Reading& reading : frame.readings) {
    v1::SensorReading sensor;
    sensor.site(static_cast<v1::SensorSite>(reading.site));
    sensor.valid(reading.valid);
    sensor.X_TS().position(convert::to_message(reading.p_TS));
    sensor.X_TS().orientation().w(reading.q_TS.w());
    sensor.X_TS().orientation().x(reading.q_TS.x());
    sensor.X_TS().orientation().y(reading.q_TS.y());
    sensor.X_TS().orientation().z(reading.q_TS.z());
    message.sensors().push_back(sensor);
  }
  return message;
}

Frame from_message(const v1::GloveFrame& message) {
  Frame frame;
  frame.sequence = message.sequence_number();
  frame.stamp = from_ns(message.stamp_ns());
  frame.left = message.left();
  frame.joint_angles = message.joint_angles();
  for (const v1::SensorReading& sensor : message.sensors()) {
    if (sensor.site() < v1::SITE_BACK_OF_HAND || sensor.site() > v1::SITE_FOREARM) continue;
    const auto& q = sensor.X_TS().orientation();
    frame.readings.push_back({static_cast<Site>(sensor.site()), sensor.valid(),
                              convert::from_message(sensor.X_TS().position()),
                              Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z())});
  }
  return frame;
}

v1::GloveButton button_message(const Frame& frame, const std::string& glove) {
  v1::GloveButton message;
  message.glove(glove);
  message.sequence_number(frame.sequence);
  message.stamp_ns(to_ns(frame.stamp));
  if (frame.held) message.held(*frame.held);
  return message;
}

v1::HandPosture to_message(const Posture& posture, const std::string& glove, const Wearer& wearer) {
  v1::HandPosture message;
  message.glove(glove);
  message.sequence_number(posture.sequence);
  message.stamp_ns(to_ns(posture.stamp));
  message.origin_ns(to_ns(posture.stamp));
  message.user(wearer.user);
  message.hand_scale(wearer.hand_scale);
  message.quality(posture.quality);
  message.X_WH(convert::to_message(posture.X_WH));
  for (std::size_t f = 0; f < posture.fingertips.size(); ++f) {
    message.fingertips()[f].valid(posture.fingertips[f].valid);
    message.fingertips()[f].p_HF(convert::to_message(posture.fingertips[f].p_HF));
  }
  message.joint_angles(posture.joint_angles);
  return message;
}

Expected<Feedback> from_message(const v1::GloveFeedback& message) {
  Feedback feedback{.stamp = from_ns(message.stamp_ns())};
  for (std::size_t f = 0; f < feedback.fingers.size(); ++f) {
    const v1::FingerFeedback& finger = message.fingers()[f];
    if (!(finger.force() >= 0 && std::isfinite(finger.force())))
      return fail("feedback with a force below 0 or not finite");
    feedback.fingers[f] = {finger.force(), finger.contact(), finger.slip(), finger.limit()};
  }
  return feedback;
}

}  // namespace prehend::glove
