#pragma once

#include "common/base/time.hpp"

namespace prehend {

/// The clock of this process: the system's when it is first asked, and steady from there. Whoever
/// compares times by it is not touched when somebody sets the system's clock; it runs on while the
/// machine sleeps.
Time process_now();

/// How far the system's clock has been set away from it since; zero where that is under 10 ms,
/// which is no step but the time between two readings.
Duration clock_step();

}  // namespace prehend
