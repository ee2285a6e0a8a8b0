#pragma once

#include <string>

#include "common/base/error.hpp"
#include "idl/Glove.h"
#include "services/glove/core/feedback.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

v1::GloveFrame to_message(const Frame& frame, const std::string& glove, const std::string& device);
/// Takes numbers as they are: checking them is the processor's work. Sites that do not exist are
/// left out.
Frame from_message(const v1::GloveFrame& message);

/// Of a frame of a device that has buttons.
v1::GloveButton button_message(const Frame& frame, const std::string& glove);

/// Fails on a force that is negative or not finite.
Expected<Feedback> from_message(const v1::GloveFeedback& message);

struct Wearer {
  std::string user;
  double hand_scale = 1;
};
v1::HandPosture to_message(const Posture& posture, const std::string& glove, const Wearer& wearer);

}  // namespace prehend::glove
