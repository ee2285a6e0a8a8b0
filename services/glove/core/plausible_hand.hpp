#pragma once

#include <string_view>

#include "services/glove/core/bare_hand.hpp"

namespace prehend::glove {

/// Among the reasons below.
inline constexpr std::string_view mirrored_hand = "a mirrored hand";

/// Why these points are no hand of that side, in m; empty: they are one. In few words, as they are
/// counted in the status:
///  - "all points in one place"     what trackers send when they have lost the hand
///  - "in millimetres", "in centimetres", "in image coordinates"
///  - "not a hand"                  bones of other lengths
///  - "a collapsed palm"            wrist and knuckles span no plane, so it points nowhere
///  - "a mirrored hand"             fingers bend to the back: it is one of the other side, or the
///                                  picture was mirrored
/// A straight hand may be of either side: only bent fingers tell.
std::string_view why_no_hand(const Landmarks& points, bool left);

/// What to do about it; empty where the word says it.
std::string_view advice_on(std::string_view reason);

}  // namespace prehend::glove
