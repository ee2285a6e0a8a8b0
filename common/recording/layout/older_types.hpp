#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

/// Types whose next version has a sequence more at its end. What was recorded as the older one is
/// read as the newer one with an empty sequence, since all bytes in front of it are the same.
namespace prehend::recording {

/// The name of the newest version of a type.
std::string_view current_type(std::string_view type);

/// The payload, with its encapsulation header, of a message of an older type as one of the newest.
void make_current(std::vector<std::uint8_t>& payload);

}  // namespace prehend::recording
