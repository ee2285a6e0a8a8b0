#pragma once

#include <array>
#include <string_view>

namespace prehend::demonstration {

/// What a hand is about when it takes something somewhere.
enum class Phase {
  rest,      // it is still and has nothing
  approach,  // it goes to something and opens
  close,     // fingers close on it
  hold,      // it has it, carries it or not
  release,   // fingers open
  retract    // it goes away, having nothing
};

inline constexpr std::array phases{Phase::rest, Phase::approach, Phase::close,
                                   Phase::hold, Phase::release,  Phase::retract};
inline constexpr std::size_t phase_count = phases.size();

std::string_view to_string(Phase phase);

}  // namespace prehend::demonstration
