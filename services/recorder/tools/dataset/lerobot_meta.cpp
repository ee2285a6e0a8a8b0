#include "services/recorder/tools/dataset/lerobot_meta.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/file_text.hpp"
#include "services/recorder/tools/dataset/lerobot_videos.hpp"

namespace prehend::recorder::dataset {
namespace {

using Json = nlohmann::ordered_json;

/// Each part as a range of episodes.
Json splits_of(const Dataset& dataset) {
  if (dataset.splits.empty()) return {{"train", fmt::format("0:{}", dataset.episodes.size())}};
  Json made = Json::object();
  std::size_t begin = 0;
  for (const auto& [name, count] : dataset.splits) {
    made[name] = fmt::format("{}:{}", begin, begin + count);
    begin += count;
  }
  return made;
}

Json video_description(Size size, int rate) {
  return {{"dtype", "video"},
          {"shape", {size.height, size.width, 3}},
          {"names", {"height", "width", "channels"}},
          {"info",
           {{"video.height", size.height},
            {"video.width", size.width},
            {"video.channels", 3},
            {"video.codec", "h264"},
            {"video.pix_fmt", "yuv420p"},
            {"video.is_depth_map", false},
            {"video.fps", rate},
            {"has_audio", false}}}};
}

}  // namespace

std::int64_t LerobotTasks::number(const std::string& words) {
  const auto found = std::ranges::find(words_, words);
  const auto place = found - words_.begin();
  if (found == words_.end()) words_.push_back(words);
  return place;
}

std::string video_name(const std::string& camera) {
  return "observation.images." + camera;
}

bool is_video(const std::string& feature) {
  return feature.starts_with(video_name(""));
}

Json lerobot_info(const Dataset& dataset, const std::vector<LerobotFeature>& features,
                  std::size_t tasks) {
  const int rate = static_cast<int>(dataset.rate);
  Json described = Json::object();
  for (const auto& [camera, size] : dataset.cameras)
    described[video_name(camera)] = video_description(even(size), rate);
  for (const LerobotFeature& feature : features) described[feature.name] = description(feature);
  Eigen::Index rows = 0;
  for (const RecordedEpisode& each : dataset.episodes) rows += each.rows.count;
  return {{"codebase_version", ""},
          {"robot_type", dataset.hand},
          {"total_episodes", dataset.episodes.size()},
          {"total_frames", rows},
          {"total_tasks", tasks},
          {"chunks_size", FilePlace::files},
          {"fps", rate},
          {"splits", splits_of(dataset)},
          {"data_path", ""},
          {"video_path", nullptr},
          {"features", described}};
}

Json all_statistics(const std::vector<NamedStatistics>& episodes) {
  Json all = Json::object();
  for (std::size_t i = 0; i < episodes.front().size(); ++i) {
    std::vector<Statistics> parts;
    for (const NamedStatistics& episode : episodes) parts.push_back(episode[i].second);
    const std::string& name = episodes.front()[i].first;
    all[name] = to_json(together(parts), is_video(name));
  }
  return all;
}

Expected<void> write_bytes(const std::filesystem::path& file, std::string_view bytes) {
  std::error_code problem;
  std::filesystem::create_directories(file.parent_path(), problem);
  if (problem) return fail(problem.message(), file.parent_path().string());
  return write_file(file, bytes);
}

Expected<void> write_table(const std::filesystem::path& file, const std::vector<Column>& columns,
                           std::size_t rows,
                           const std::vector<std::pair<std::string, std::string>>& metadata) {
  const auto bytes = parquet(columns, rows, metadata);
  return write_bytes(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Expected<void> write_json(const std::filesystem::path& file, const Json& json) {
  return write_bytes(file, json.dump(4, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace prehend::recorder::dataset
