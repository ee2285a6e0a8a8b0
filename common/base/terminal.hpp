#pragma once

namespace prehend {

/// Is this file a terminal whose cursor can be moved? TERM=dumb, as of editors, says that it is
/// not: there lines are printed one below the other.
bool has_cursor(int file);

}  // namespace prehend
