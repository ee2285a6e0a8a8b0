#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/base/error.hpp"
#include "common/dds/participant.hpp"
#include "services/cli/tools/doctor/check.hpp"

namespace prehend::cli {

/// Which glove leads which hand: that whose frame is the origin of its commands, and that which is
/// told what it feels. The first is not seen where clocks of hosts differ, the second not of hands
/// that feel nothing.
class Leading {
 public:
  static Expected<Leading> create(dds::Participant& participant);
  /// Everything that has come since.
  void hear();
  /// Of several hands each has a glove of its own, on a hand of its own side. One hand may be led
  /// by either.
  Check judge() const;

 private:
  Leading(dds::Reader<v1::GloveFrame> frames, dds::Reader<v1::GloveFeedback> feedback,
          dds::Reader<v2::HandCommand> commands);

  dds::Reader<v1::GloveFrame> frames_;
  dds::Reader<v1::GloveFeedback> feedback_;
  dds::Reader<v2::HandCommand> commands_;
  std::map<std::int64_t, std::string> frame_of_;  // the glove, by the frame's stamp in ns
  std::map<std::string, bool> is_left_;           // by glove
  std::map<std::string, std::string> glove_;      // by hand
  std::map<std::string, std::string> model_;      // by hand
};

}  // namespace prehend::cli
