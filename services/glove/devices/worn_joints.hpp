#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/frame_clock.hpp"

namespace prehend::glove {

/// Makes frames of what a glove that measures joints counts. Where the hand is, a tracker on its
/// back says, at options.wrist_port; while that is silent, the back of the hand is not valid.
/// Without one the hand stays at the scene's X_WH.
class WornJoints {
 public:
  /// Fails where the tracker or options.joint_gains cannot be.
  static Expected<std::unique_ptr<WornJoints>> create(const DeviceOptions& options);

  /// Of the tracker, too. Called once.
  void start(DeviceSink sink);
  /// The glove has begun anew, with so many sensors: without a calibration for these typical gains
  /// are used, which is said.
  void begin(std::size_t sensors);
  /// Counts of as many sensors. held: numbers of the buttons; nothing: it has none.
  void deliver(std::vector<double> counts, std::optional<std::vector<std::uint8_t>> held, Time now);

  /// Of the sensors that it has begun with.
  const JointGains& gains() const { return gains_; }
  const DeviceSink& sink() const { return sink_; }

 private:
  WornJoints(const DeviceOptions& options, std::unique_ptr<Device> tracker);
  Reading wrist();

  std::string path_;
  bool left_;
  Eigen::Vector3d left_to_right_T_;
  JointGains gains_;
  Reading resting_{};
  DeviceSink sink_;
  std::uint64_t sequence_ = 0;
  FrameClock clock_;
  std::mutex mutex_;  // guards what the tracker saw last
  Reading seen_{.valid = false};
  std::chrono::steady_clock::time_point seen_at_{};
  std::unique_ptr<Device> tracker_;  // last: its thread ends before the rest goes
};

}  // namespace prehend::glove
