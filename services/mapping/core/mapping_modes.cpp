#include "services/mapping/core/mapping_modes.hpp"

#include <fmt/format.h>

#include <optional>
#include <sstream>

#include "common/base/named_values.hpp"

namespace prehend::mapping {

namespace {

/// What an operator says of the other two.
constexpr auto object_words = named_values<bool>({{false, "direct"}, {true, "intelligent"}});
constexpr auto placement_words = named_values<bool>({{true, "placement"}, {false, "no-placement"}});

/// One of the words for something has been said; false when another one was said before.
template <class Value>
bool say(std::optional<Value>& said, Value value) {
  const bool first = !said || *said == value;
  said = value;
  return first;
}

}  // namespace

Expected<MappingModes> changed(MappingModes modes, std::string_view order) {
  std::optional<FingerMode> fingers;
  std::optional<bool> intelligent, placement;
  std::istringstream words{std::string(order)};
  for (std::string word; words >> word;) {
    bool agrees = true;
    if (const auto mode = finger_modes.value(word))
      agrees = say(fingers, *mode);
    else if (const auto objects = object_words.value(word))
      agrees = say(intelligent, *objects);
    else if (const auto place = placement_words.value(word))
      agrees = say(placement, *place);
    else
      return fail(fmt::format("there is no mode «{}»", word), "set mode",
                  finger_modes.list() + "; " + object_words.list() + "; " + placement_words.list());
    if (!agrees)
      return fail(fmt::format("«{}» contradicts what was said before", word), "set mode");
  }
  if (!fingers && !intelligent && !placement) return fail("no mode is named", "set mode");
  modes.fingers = fingers.value_or(modes.fingers);
  modes.intelligent = intelligent.value_or(modes.intelligent);
  modes.placement = placement.value_or(modes.placement);
  return modes;
}

std::string to_string(const MappingModes& modes) {
  return fmt::format("{} {} {}", finger_modes.name(modes.fingers),
                     object_words.name(modes.intelligent), placement_words.name(modes.placement));
}

}  // namespace prehend::mapping
