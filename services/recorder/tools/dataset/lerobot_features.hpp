#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "services/recorder/core/dataset/parquet.hpp"
#include "services/recorder/tools/dataset/dataset.hpp"

namespace prehend::recorder::dataset {

/// Numbers of every row as LeRobot names them.
struct LerobotFeature {
  enum class Kind { real, whole, truth };  // float32, int64, bool
  std::string name;
  Kind kind = Kind::real;
  std::vector<std::string> columns;  // empty: it has one, without a name
  Table values;
};

/// Where an episode stands in the dataset.
struct LerobotPlace {
  std::int64_t episode = 0, first_row = 0, task = 0;
};

/// Robot: observation.state, action, observation.NAME. Objects: all in
/// observation.environment_state, as LeRobot's policies expect them. With `judged` next.reward and
/// next.success. Then what every dataset has: timestamp, frame_index, episode_index, ...
std::vector<LerobotFeature> lerobot_features(const RecordedEpisode& recorded, double rate,
                                             const LerobotPlace& place, bool judged);

/// As meta/info.json describes it.
nlohmann::ordered_json description(const LerobotFeature& feature);

/// Behind the values that the column has; an empty one becomes the feature's.
void append(Column& column, const LerobotFeature& feature);

/// In an order that does not change: min, max, mean, std, count. `picture`: three numbers, one a
/// colour, in lists of their own.
nlohmann::ordered_json to_json(const Statistics& statistics, bool picture);
/// The same as columns of one row, «stats/NAME/min».
void append(std::vector<Column>& row, const std::string& name, const Statistics& statistics,
            bool picture);

}  // namespace prehend::recorder::dataset
