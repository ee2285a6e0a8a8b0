#include <fmt/format.h>

#include "services/recorder/tools/dataset/layouts.hpp"
#include "services/recorder/tools/dataset/lerobot_meta.hpp"
#include "services/recorder/tools/dataset/lerobot_videos.hpp"

// The layout: LeRobotDataset v2.1, one file an episode and lines of JSON about them.
namespace prehend::recorder::dataset {
namespace {

using Json = nlohmann::ordered_json;

std::string line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

class LerobotV21Writer {
 public:
  LerobotV21Writer(const Dataset& dataset, std::filesystem::path folder)
      : dataset_(dataset), folder_(std::move(folder)), judged_(dataset.all_judged()) {}

  Expected<void> write(const Written& written) {
    for (std::size_t i = 0; i < dataset_.episodes.size(); ++i) {
      if (auto done = episode(dataset_.episodes[i], static_cast<std::int64_t>(i)); !done)
        return done;
      written();
    }
    return write_meta();
  }

 private:
  static std::string chunk(std::int64_t number) {
    return fmt::format("chunk-{:03d}", number / FilePlace::files);
  }

  Expected<void> episode(const RecordedEpisode& recorded, std::int64_t number) {
    const std::string& words = recorded.episode.task;
    const auto features = lerobot_features(recorded, dataset_.rate,
                                           {number, first_row_, tasks_.number(words)}, judged_);
    if (number == 0) first_features_ = features;
    first_row_ += recorded.rows.count;

    Json of = Json::object();
    const std::string name = fmt::format("episode_{:06d}", number);
    for (const auto& [camera, size] : dataset_.cameras) {
      const auto colours =
          write_video(recorded, camera, even(size), static_cast<int>(dataset_.rate),
                      folder_ / "videos" / chunk(number) / video_name(camera) / (name + ".mp4"));
      if (!colours) return tl::unexpected(colours.error());
      of[video_name(camera)] = to_json(*colours, true);
    }
    std::vector<Column> data(features.size());
    for (std::size_t i = 0; i < features.size(); ++i) {
      append(data[i], features[i]);
      of[features[i].name] = to_json(statistics(features[i].values), false);
    }
    episodes_ += line({{"episode_index", number},
                       {"tasks", Json::array({words})},
                       {"length", recorded.rows.count}});
    statistics_ += line({{"episode_index", number}, {"stats", of}});
    return write_table(folder_ / "data" / chunk(number) / (name + ".parquet"), data,
                       static_cast<std::size_t>(recorded.rows.count));
  }

  Expected<void> write_meta() {
    const auto meta = folder_ / "meta";
    const std::size_t count = dataset_.episodes.size();
    Json info = lerobot_info(dataset_, first_features_, tasks_.words().size());
    info["codebase_version"] = "v2.1";
    info["total_videos"] = count * dataset_.cameras.size();
    info["total_chunks"] = (count - 1) / FilePlace::files + 1;
    info["data_path"] = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet";
    if (!dataset_.cameras.empty())
      info["video_path"] =
          "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4";
    if (auto done = write_json(meta / "info.json", info); !done) return done;
    std::string tasks;
    for (std::size_t i = 0; i < tasks_.words().size(); ++i)
      tasks += line({{"task_index", i}, {"task", tasks_.words()[i]}});
    if (auto done = write_bytes(meta / "tasks.jsonl", tasks); !done) return done;
    if (auto done = write_bytes(meta / "episodes.jsonl", episodes_); !done) return done;
    return write_bytes(meta / "episodes_stats.jsonl", statistics_);
  }

  const Dataset& dataset_;
  std::filesystem::path folder_;
  bool judged_;
  LerobotTasks tasks_;
  std::vector<LerobotFeature> first_features_;
  std::int64_t first_row_ = 0;
  std::string episodes_, statistics_;  // lines of JSON
};

}  // namespace

Expected<void> write_lerobot_v21(const Dataset& dataset, const std::filesystem::path& folder,
                                 const Written& written) {
  return LerobotV21Writer(dataset, folder).write(written);
}

}  // namespace prehend::recorder::dataset
