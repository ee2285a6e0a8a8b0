#pragma once

#include "common/model/human_hand.hpp"
#include "services/glove/core/joint_sensors.hpp"
#include "services/glove/devices/emulator.hpp"
#include "services/glove/devices/joint_protocol.hpp"

namespace prehend::glove::joint {

struct EmulatorOptions {
  JointGains gains;       // of the person who wears it
  double hand_scale = 1;  // of that person
  bool right = true;      // a glove for the right hand
};

/// A joint-angle glove with as many sensors as gains. What it feels are the joint angles of the
/// frame or, where that has none, those that reach its fingertips. Switched on it does not stream
/// and measures every 10 ms.
class Emulator final : public glove::Emulator {
 public:
  explicit Emulator(const EmulatorOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::vector<std::string> measure(const Frame& frame, Duration now) override;

 private:
  std::string command();

  EmulatorOptions options_;
  model::HumanHand hand_;
  model::HumanPosture posture_;
  Counts counts_;
  std::string pending_;  // of a command that is not complete
  bool streaming_ = false;
  Duration period_ = std::chrono::milliseconds(10);
  Duration next_{};  // when the next sample is due
};

}  // namespace prehend::glove::joint
