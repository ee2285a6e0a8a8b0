#pragma once

#include <string>
#include <string_view>

namespace prehend {

/// A text of somebody else's, as it may stand on a terminal: control characters, which would move
/// the cursor, change what stands there or begin a line of its own, and bytes that are no UTF-8
/// become \\x1b and the like. `keep`: characters that stay all the same.
std::string printable(std::string_view text, std::string_view keep = {});

}  // namespace prehend
