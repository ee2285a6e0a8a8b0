#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/pose.hpp"

namespace prehend::console {

/// What the glove's device `landmarks` hears of a hand that the page tracks: a line of its format
/// (services/glove/README.md). The page's own format differs in two things, since a browser has
/// neither the lab's clock nor its frames: `age_s` instead of a stamp, and points of a hand in the
/// room are on the table. T: the tracker's frame. Nothing in the body is trusted.
Expected<std::string> hand_line(std::string_view body, std::int64_t now_ns, const Pose& X_TW);

}  // namespace prehend::console
