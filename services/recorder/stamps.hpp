#pragma once

#include <cstdint>
#include <prehend/base/time.hpp>
#include <prehend/types/type.hpp>
#include <vector>

namespace prehend::recorder {

/// Adds to every time stamp inside a CDR message of this type: the fields of 64 bits whose name
/// ends in `_ns`, apart from those that are 0 (they mean «none»). Nothing else of the bytes
/// changes. False, and nothing is changed, when the message is not of this type.
bool shift_stamps(const types::Structure& type, Duration shift, std::vector<std::uint8_t>& message);

}  // namespace prehend::recorder
