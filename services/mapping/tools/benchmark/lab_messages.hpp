#pragma once

#include <string>

#include "common/dds/raw.hpp"
#include "common/dds/topics.hpp"
#include "services/mapping/core/mapping.hpp"

/// What a take says, as its topics say it.
namespace prehend::mapping {

v1::HandPosture to_message(const Posture& posture, const std::string& user);
v1::ObjectDetection to_message(const Detection& detection);
/// model: kind of hand.
v1::HandState to_message(const RobotState& state, const std::string& model);

/// A message as a sample of its topic, for a RawWriter or a file.
template <class P>
dds::RawSample raw_sample(const dds::Topic<P>& topic, const typename P::type& message) {
  dds::RawSample sample;
  sample.payload = dds::encode(topic, message);
  P type;
  dds::rtps::InstanceHandle_t handle;
  if (dds::find_key(type, &message, handle))
    for (std::size_t i = 0; i < sample.instance.size(); ++i) sample.instance[i] = handle.value[i];
  return sample;
}

/// What whoever reads the message takes it for: a rotation is rounded on its way.
Posture as_read(const Posture& posture);
Detection as_read(const Detection& detection);
RobotState as_read(const RobotState& state);
Pose as_read(const Pose& X);

}  // namespace prehend::mapping
