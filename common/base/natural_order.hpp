#pragma once

#include <string_view>

namespace prehend {

/// Whether a comes before b for a person: runs of digits count as numbers of any length, so that
/// `shot2` comes before `shot10`; all else byte by byte. A strict order over all texts: of two that
/// differ in leading zeros only, the one with fewer comes first.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace prehend
