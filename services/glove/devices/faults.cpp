#include "services/glove/devices/faults.hpp"

#include <utility>

namespace prehend::glove {
namespace {

constexpr double lever = 0.05;  // m, from a joint to what it moves

bool within(Duration now, double begin, double length) {
  const double t = to_seconds(now);
  return begin >= 0 && t >= begin && t < begin + length;
}

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
  if (record.empty()) return record;
  if (random_.uniform() < options_.drop_bytes) record.erase(random_.index(record.size()), 1);
  if (record.size() > 1 && random_.uniform() < options_.swap_bytes) {
    const std::size_t i = random_.index(record.size() - 1);
    std::swap(record[i], record[i + 1]);
  }
  std::string foreign;
  if (random_.uniform() < options_.garbage)
    for (std::size_t n = 1 + random_.index(20); n > 0; --n)
      foreign.push_back(static_cast<char>(random_.bits() & 0xff));
  return foreign + record;
}

bool Faults::silent(Duration since_start) const {
  return within(since_start, options_.silent_at, options_.silent_for);
}

bool Faults::unplugged(Duration since_start) const {
  return within(since_start, options_.unplug_at, options_.unplug_for);
}

}  // namespace prehend::glove
