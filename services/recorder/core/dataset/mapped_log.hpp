#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/recorder/core/dataset/rows.hpp"

namespace prehend::recorder::dataset {

/// What something is to a policy.
enum class Role { state, action, observation };

/// One field of a topic of anybody's recording, as somebody has mapped it. Either numbers or poses.
struct Track {
  std::string name;  // of an observation: its feature
  Role role = Role::observation;
  std::vector<std::string> columns;  // of the numbers; of poses what stands before x, y, ...
  Numbers numbers;
  Poses poses;

  const std::vector<Time>& times() const { return poses.empty() ? numbers.times : poses.times; }
};

/// A message by which somebody marked an episode.
struct Mark {
  Time time;
  bool ends = true, begins = true;
  std::optional<bool> success;  // of the one that ends
};

struct MappedLog {
  std::vector<Track> tracks;  // in order of their columns
  std::map<std::string, Camera> cameras;
  std::vector<Mark> marks;  // in order of time
};

/// Where episodes begin and end. What is given counts, else marks, else gaps, else it is all one.
struct EpisodeRule {
  std::vector<std::pair<double, double>> given;  // s after the recording's first message
  Duration gap{};  // without an action that parts episodes; 0: none does
  std::string task;
};

/// Parts of time in which there are actions.
std::vector<Episode> find_episodes(const MappedLog& log, const EpisodeRule& rule, Time start);

/// The episode at a fixed rate, from the moment at which everything that is mapped had been told.
/// Fails where something that is mapped is not told in it, and as the other make_rows().
Expected<Rows> make_rows(const MappedLog& log, const Episode& episode, const RowOptions& options);

/// These episodes as somebody gave them: seconds after `start`.
std::vector<Episode> given_episodes(const std::vector<std::pair<double, double>>& given, Time start,
                                    const std::string& task);

}  // namespace prehend::recorder::dataset
