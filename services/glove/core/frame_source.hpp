#pragma once

#include <cstdint>
#include <optional>

#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// Frames that can be asked for by number: a recording, or a hand that is computed.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Frame n with its stamp counted from the first frame's (1970-01-01); nothing after the end.
  virtual std::optional<Frame> frame(std::uint64_t n) const = 0;
};

}  // namespace prehend::glove
