#include <fmt/format.h>

#include "services/recorder/tools/dataset/layouts.hpp"
#include "services/recorder/tools/dataset/lerobot_meta.hpp"
#include "services/recorder/tools/dataset/lerobot_videos.hpp"

// [Cadene2024]; the layout: LeRobotDataset v3.0,
// https://huggingface.co/docs/lerobot/lerobot-dataset-v3
namespace prehend::recorder::dataset {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t max_data_bytes = 100u << 20;  // of a file

/// Puts a row of one more episode behind those of the others.
void append_row(std::vector<Column>& table, const std::vector<Column>& row) {
  if (table.empty()) {
    table = row;
    return;
  }
  for (std::size_t i = 0; i < table.size(); ++i)
    std::visit(
        [&](auto& values) {
          const auto& more = std::get<std::decay_t<decltype(values)>>(row[i].values);
          values.insert(values.end(), more.begin(), more.end());
        },
        table[i].values);
}

Column one(std::string name, std::int64_t value) {
  return {std::move(name), {}, std::vector<std::int64_t>{value}};
}
Column one(std::string name, double value) {
  return {std::move(name), {}, std::vector<double>{value}};
}

/// By which pandas finds its index, the words, again.
std::string pandas_of_tasks() {
  const auto column = [](const Json& name, const char* field, const char* type, const char* numpy) {
    return Json{{"name", name},
                {"field_name", field},
                {"pandas_type", type},
                {"numpy_type", numpy},
                {"metadata", nullptr}};
  };
  return Json{{"index_columns", {"__index_level_0__"}},
              {"column_indexes", Json::array()},
              {"columns",
               {column("task_index", "task_index", "int64", "int64"),
                column(nullptr, "__index_level_0__", "unicode", "object")}},
              {"pandas_version", "2.0.0"}}
      .dump();
}

class LerobotWriter {
 public:
  LerobotWriter(const Dataset& dataset, std::filesystem::path folder)
      : dataset_(dataset), folder_(std::move(folder)), judged_(dataset.all_judged()) {
    for (const auto& [camera, size] : dataset.cameras)
      videos_.emplace(camera, CameraVideos(folder_ / "videos" / video_name(camera), camera,
                                           even(size), static_cast<int>(dataset.rate)));
  }

  Expected<void> write(const Written& written) {
    for (std::size_t i = 0; i < dataset_.episodes.size(); ++i) {
      if (auto done = episode(dataset_.episodes[i], static_cast<std::int64_t>(i)); !done)
        return done;
      written();
    }
    if (auto done = write_data(); !done) return done;
    for (auto& [camera, videos] : videos_)
      if (auto done = videos.close(); !done) return done;
    return write_meta();
  }

 private:
  Expected<void> episode(const RecordedEpisode& recorded, std::int64_t number) {
    const std::int64_t count = recorded.rows.count;
    const auto features =
        lerobot_features(recorded, dataset_.rate,
                         {number, first_row_, tasks_.number(recorded.episode.task)}, judged_);
    if (number == 0) first_features_ = features;
    std::vector<Column> row{one("episode_index", number),
                            {"tasks", {1}, std::vector<std::string>{recorded.episode.task}},
                            one("length", count),
                            one("data/chunk_index", data_place_.chunk),
                            one("data/file_index", data_place_.file),
                            one("dataset_from_index", first_row_),
                            one("dataset_to_index", first_row_ + count)};
    NamedStatistics named;
    for (auto& [camera, videos] : videos_) {
      const auto video = videos.add(recorded);
      if (!video) return tl::unexpected(video.error());
      const std::string prefix = "videos/" + video_name(camera) + "/";
      row.push_back(one(prefix + "chunk_index", video->place.chunk));
      row.push_back(one(prefix + "file_index", video->place.file));
      row.push_back(one(prefix + "from_timestamp", video->from));
      row.push_back(one(prefix + "to_timestamp", video->to));
      named.emplace_back(video_name(camera), video->colours);
    }
    for (const LerobotFeature& feature : features)
      named.emplace_back(feature.name, statistics(feature.values));
    for (const auto& [name, of] : named) append(row, name, of, is_video(name));
    row.push_back(one("meta/episodes/chunk_index", std::int64_t{0}));
    row.push_back(one("meta/episodes/file_index", std::int64_t{0}));
    append_row(episodes_, row);
    statistics_.push_back(std::move(named));
    first_row_ += count;
    return add_data(features);
  }

  Expected<void> add_data(const std::vector<LerobotFeature>& features) {
    data_.resize(features.size());
    for (std::size_t i = 0; i < features.size(); ++i) {
      append(data_[i], features[i]);
      data_bytes_ += static_cast<std::size_t>(features[i].values.size()) * sizeof(float);
    }
    return data_bytes_ < max_data_bytes ? Expected<void>() : write_data();
  }

  Expected<void> write_data() {
    if (data_.empty()) return {};
    auto done = write_table(folder_ / "data" / (data_place_.path() + ".parquet"), data_,
                            data_.back().count());
    data_place_.advance();
    data_.clear();
    data_bytes_ = 0;
    return done;
  }

  Expected<void> write_meta() {
    const auto meta = folder_ / "meta";
    Json info = lerobot_info(dataset_, first_features_, tasks_.words().size());
    info["codebase_version"] = "v3.0";
    info["data_files_size_in_mb"] = max_data_bytes >> 20;
    info["video_files_size_in_mb"] = 200;
    info["data_path"] = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet";
    if (!videos_.empty())
      info["video_path"] = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4";
    if (auto done = write_json(meta / "info.json", info); !done) return done;
    if (auto done = write_json(meta / "stats.json", all_statistics(statistics_)); !done)
      return done;
    std::vector<std::int64_t> numbers;
    for (std::size_t i = 0; i < tasks_.words().size(); ++i)
      numbers.push_back(static_cast<std::int64_t>(i));
    if (auto done =
            write_table(meta / "tasks.parquet",
                        {{"task_index", {}, numbers}, {"__index_level_0__", {}, tasks_.words()}},
                        numbers.size(), {{"pandas", pandas_of_tasks()}});
        !done)
      return done;
    return write_table(meta / "episodes" / (FilePlace{}.path() + ".parquet"), episodes_,
                       dataset_.episodes.size());
  }

  const Dataset& dataset_;
  std::filesystem::path folder_;
  bool judged_;
  LerobotTasks tasks_;
  std::map<std::string, CameraVideos> videos_;
  std::vector<LerobotFeature> first_features_;
  std::vector<Column> data_;  // of the file that is being filled
  std::size_t data_bytes_ = 0;
  FilePlace data_place_;
  std::int64_t first_row_ = 0;
  std::vector<Column> episodes_;
  std::vector<NamedStatistics> statistics_;
};

}  // namespace

Expected<void> write_lerobot(const Dataset& dataset, const std::filesystem::path& folder,
                             const Written& written) {
  return LerobotWriter(dataset, folder).write(written);
}

}  // namespace prehend::recorder::dataset
