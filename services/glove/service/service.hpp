#pragma once

#include <memory>
#include <string>

#include "common/service/shell.hpp"
#include "services/glove/core/processor.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/service/messages.hpp"

namespace prehend::glove {

/// The shell around device and processor: frames go out on glove/frame, hands on hand/posture.
/// One call at a time, whoever calls: a frame is worked on in the thread of the device that brings
/// it (Shell::exclusively), everything else in that of the shell.
class Service {
 public:
  /// Reads the configuration, makes the device and starts it.
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);

 private:
  Service(service::Shell& shell, const DeviceKind& kind, const DeviceOptions& options,
          Wearer wearer, const model::HumanHand& hand);
  void connect(std::unique_ptr<Device> device);
  void on_frame(const Frame& frame);
  void on_feedback(const v1::GloveFeedback& message, const dds::SampleInfo& info);
  void on_tick(Time now);
  void degrade(const std::string& line);

  service::Shell& shell_;
  DeviceKind kind_;
  std::string glove_;
  Eigen::Vector3d left_to_right_T_;  // normal of the plane that a left hand is mirrored by
  Wearer wearer_;
  Processor processor_;
  service::Shell::Output<v1::GloveFrame> frames_;
  service::Shell::Output<v1::HandPosture> postures_;
  service::Shell::Output<v1::GloveButton> buttons_;
  Time started_{}, last_frame_{}, last_posture_{};
  std::string complaint_;  // of the device; empty: none
  std::string last_reject_;
  std::string degraded_;            // what was said last; empty: all is well
  std::unique_ptr<Device> device_;  // last: its thread ends before the rest goes
};

}  // namespace prehend::glove
