#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/recording/types/type.hpp"

namespace prehend::recording::types {

/// Moves every time stamp inside a CDR message of this type: the fields of 64 bits whose name ends
/// in `_ns`, apart from those that are 0 (they mean «none»). `moved` gives a stamp (ns) its new
/// value. Nothing else of the bytes changes. False, and nothing is changed, when the message is not
/// of this type.
bool move_stamps(const Structure& type, const std::function<std::int64_t(std::int64_t)>& moved,
                 std::vector<std::uint8_t>& message);

}  // namespace prehend::recording::types
