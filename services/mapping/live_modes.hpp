#pragma once

#include <prehend/base/error.hpp>
#include <string>
#include <string_view>

#include "mapping.hpp"

namespace prehend::mapping {

/// What an operator may change while the mapping runs; see MappingOptions.
struct LiveModes {
  FingerMode fingers = FingerMode::joints;
  bool intelligent = true;
  bool placement = true;  // counts where intelligent does

  bool operator==(const LiveModes&) const = default;
};

/// The modes after an order of one or more words: joints, cartesian, combined or retargeting;
/// direct (whatever the object) or intelligent; placement or no-placement. What is not named stays.
/// Fails on other words, and on two that contradict each other.
Expected<LiveModes> changed(LiveModes modes, std::string_view order);

/// The same words for all of it.
std::string to_string(const LiveModes& modes);

}  // namespace prehend::mapping
