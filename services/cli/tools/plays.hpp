#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend demo`: gives the play that the arguments choose, a grasp or a task. With --targets it
/// only says what must be built for it. Returns the exit code.
int play(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
