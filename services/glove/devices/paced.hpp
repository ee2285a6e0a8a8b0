#pragma once

#include <memory>
#include <thread>

#include "services/glove/core/frame_source.hpp"
#include "services/glove/devices/device.hpp"

namespace prehend::glove {

struct PacedOptions {
  /// Deliver every frame even if late, with the stamps of the source (a recording). Otherwise
  /// frames whose time is over are skipped and stamps are those of delivery (a sensor).
  bool every_frame = false;
  double rate = 30;         // Hz, of a source that does not end
  std::string at_end = {};  // said when the source has ended
};

/// Plays a source at its own pace.
class PacedDevice final : public Device {
 public:
  PacedDevice(std::unique_ptr<FrameSource> source, PacedOptions options);
  void start(DeviceSink sink) override;

 private:
  void run(const std::stop_token& stop, const DeviceSink& sink) const;

  std::unique_ptr<FrameSource> source_;
  PacedOptions options_;
  std::jthread thread_;  // last: joined before the rest goes
};

}  // namespace prehend::glove
