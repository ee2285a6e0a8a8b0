#include "services/glove/devices/faults.hpp"

#include <utility>

#include "common/serial/line_faults.hpp"

namespace prehend::glove {
namespace {

constexpr double lever = 0.05;  // m, from a joint to what it moves

}  // namespace

Frame Faults::spoil(Frame frame) {
  if (options_.noise > 0) {
    for (Reading& reading : frame.readings) reading.p_TS += random_.normal3(options_.noise);
    for (double& angle : frame.joint_angles) angle += random_.normal(options_.noise / lever);
  }
  if (random_.uniform() < options_.extreme) {
    if (!frame.readings.empty())
      frame.readings[random_.index(frame.readings.size())].p_TS +=
          random_.uniform(0.05, 0.5) * random_.normal3(1).normalized();
    if (!frame.joint_angles.empty())
      frame.joint_angles[random_.index(frame.joint_angles.size())] = random_.uniform(-2, 2);
  }
  return frame;
}

std::string Faults::spoil(std::string record) {
  return serial::spoil(std::move(record),
                       {options_.garbage, options_.drop_bytes, options_.swap_bytes}, random_);
}

bool Faults::silent(Duration since_start) const {
  return serial::within(since_start, options_.silent_at, options_.silent_for);
}

bool Faults::unplugged(Duration since_start) const {
  return serial::within(since_start, options_.unplug_at, options_.unplug_for);
}

}  // namespace prehend::glove
