#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/tools/dataset/lerobot_features.hpp"

namespace prehend::recorder::dataset {

/// The words of all tasks, numbered as they come.
class LerobotTasks {
 public:
  std::int64_t number(const std::string& words);
  const std::vector<std::string>& words() const { return words_; }

 private:
  std::vector<std::string> words_;
};

/// observation.images.CAMERA
std::string video_name(const std::string& camera);

/// What meta/info.json says in every version; features are those of the first episode.
nlohmann::ordered_json lerobot_info(const Dataset& dataset,
                                    const std::vector<LerobotFeature>& features, std::size_t tasks);

/// The statistics of the whole dataset from those of its episodes, by feature.
using NamedStatistics = std::vector<std::pair<std::string, Statistics>>;
nlohmann::ordered_json all_statistics(const std::vector<NamedStatistics>& episodes);
bool is_video(const std::string& feature);

/// Makes the folders on the way.
Expected<void> write_bytes(const std::filesystem::path& file, std::string_view bytes);
Expected<void> write_table(const std::filesystem::path& file, const std::vector<Column>& columns,
                           std::size_t rows,
                           const std::vector<std::pair<std::string, std::string>>& metadata = {});
Expected<void> write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace prehend::recorder::dataset
