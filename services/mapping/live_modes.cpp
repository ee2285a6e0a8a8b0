#include "live_modes.hpp"

#include <fmt/format.h>

#include <optional>
#include <sstream>

namespace prehend::mapping {

namespace {

/// One of the words for something has been said; false when another one was said before.
template <class Value>
bool say(std::optional<Value>& said, Value value) {
  const bool first = !said || *said == value;
  said = value;
  return first;
}

}  // namespace

Expected<LiveModes> changed(LiveModes modes, std::string_view order) {
  std::optional<FingerMode> fingers;
  std::optional<bool> intelligent, placement;
  std::istringstream words{std::string(order)};
  for (std::string word; words >> word;) {
    bool agrees = true;
    if (const auto mode = finger_mode_from_string(word))
      agrees = say(fingers, *mode);
    else if (word == "direct" || word == "intelligent")
      agrees = say(intelligent, word == "intelligent");
    else if (word == "placement" || word == "no-placement")
      agrees = say(placement, word == "placement");
    else
      return fail(fmt::format("there is no mode «{}»", word), "set mode",
                  "joints, cartesian, combined or retargeting; direct or intelligent; placement or "
                  "no-placement");
    if (!agrees)
      return fail(fmt::format("«{}» contradicts what was said before", word), "set mode");
  }
  if (!fingers && !intelligent && !placement) return fail("no mode is named", "set mode");
  modes.fingers = fingers.value_or(modes.fingers);
  modes.intelligent = intelligent.value_or(modes.intelligent);
  modes.placement = placement.value_or(modes.placement);
  return modes;
}

std::string to_string(const LiveModes& modes) {
  return fmt::format("{} {} {}", to_string(modes.fingers),
                     modes.intelligent ? "intelligent" : "direct",
                     modes.placement ? "placement" : "no-placement");
}

}  // namespace prehend::mapping
