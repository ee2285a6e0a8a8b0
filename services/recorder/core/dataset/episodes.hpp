#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/recorder/core/dataset/recording_log.hpp"

namespace prehend::recorder::dataset {

/// A part of a recording that a policy is shown as a whole.
struct Episode {
  Time begin, end;
  std::string task;             // in words
  std::string object;           // that is grasped; empty: not known
  std::optional<bool> success;  // where it was judged
};

/// How long a grasp's episode goes on after its judgement.
inline constexpr Duration tail = std::chrono::seconds(1);

/// One rule counts for a recording, the first that applies:
/// - an episode each task that the robot did, as the performer judged it;
/// - an episode each demonstration between the operator's marks, a success where every grasp in it
///   was held and there was one;
/// - an episode each judged grasp, from the end of the one before (or the first command) to
///   `tail` after the judgement, or what was done with the object, but half way to the next one at
///   most, a success where it was held;
/// - all of it, from the first command to the last one, not judged.
/// Nothing of a recording without commands.
std::vector<Episode> find_episodes(const RecordingLog& log);

}  // namespace prehend::recorder::dataset
