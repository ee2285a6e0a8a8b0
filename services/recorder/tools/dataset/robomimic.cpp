#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "services/recorder/tools/dataset/hdf5_file.hpp"
#include "services/recorder/tools/dataset/layouts.hpp"
#include "services/recorder/tools/dataset/pictures.hpp"

// [Mandlekar2021]; the layout: https://robomimic.github.io/docs/datasets/overview.html
namespace prehend::recorder::dataset {
namespace {

using Json = nlohmann::ordered_json;
constexpr auto precise = Hdf5File::Precision::twofold;

/// What the next row sees; the last row sees itself.
Table next_of(const Table& values) {
  Table next = values;
  next.topRows(values.rows() - 1) = values.bottomRows(values.rows() - 1);
  return next;
}

/// The last action of a success is worth 1.
Eigen::VectorXd last_one(Eigen::Index count, bool one) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(count);
  if (one) values[count - 1] = 1;
  return values;
}

class RobomimicWriter {
 public:
  RobomimicWriter(const Dataset& dataset, Hdf5File file)
      : dataset_(dataset), file_(std::move(file)) {
    std::vector<Statistics> ranges;
    for (const RecordedEpisode& each : dataset.episodes)
      ranges.push_back(statistics(each.rows.action.values));
    range_ = together(ranges);
  }

  Expected<void> write(const Written& written) {
    std::int64_t total = 0;
    for (std::size_t i = 0; i < dataset_.episodes.size(); ++i) {
      if (auto done = demo(dataset_.episodes[i], fmt::format("demo_{}", i)); !done) return done;
      total += dataset_.episodes[i].rows.count;
      written();
    }
    file_.attribute("/data", "total", total);
    file_.attribute("/data", "env_args", environment());
    file_.attribute("/data", "action_min", range_.min);
    file_.attribute("/data", "action_max", range_.max);
    file_.attribute("/data", "action_names",
                    Json(dataset_.episodes.front().rows.action.columns).dump());
    for (const auto& [name, demos] : masks_) file_.write("/mask/" + name, demos);
    return file_.close();
  }

 private:
  Expected<void> demo(const RecordedEpisode& recorded, const std::string& name) {
    const Rows& rows = recorded.rows;
    const std::string group = "/data/" + name;
    observation(group, "state", rows.state.values);
    for (const Feature& feature : rows.others) observation(group, feature.name, feature.values);
    for (const auto& [camera, size] : dataset_.cameras) {
      const std::string key = camera + "_image";
      if (auto done = pictures(recorded, camera, group + "/obs/" + key, false); !done) return done;
      if (auto done = pictures(recorded, camera, group + "/next_obs/" + key, true); !done)
        return done;
    }
    const bool success = recorded.episode.success.value_or(false);
    file_.write(group + "/actions", scaled(rows.action.values, range_), precise);
    file_.write(group + "/actions_abs", rows.action.values, precise);
    file_.write(group + "/states", Table(rows.count, 0), precise);  // there is no such simulator
    file_.write(group + "/rewards", last_one(rows.count, success), precise);
    file_.write(group + "/dones", last_one(rows.count, true), precise);
    file_.attribute(group, "num_samples", static_cast<std::int64_t>(rows.count));
    file_.attribute(group, "task", recorded.episode.task);
    file_.attribute(group, "ep_meta", Json{{"lang", recorded.episode.task}}.dump());
    file_.attribute(group, "recording", recorded.file.filename().string());
    file_.attribute(group, "begin_ns", static_cast<std::int64_t>(to_ns(rows.begin)));
    if (recorded.episode.success) {
      file_.attribute(group, "success", success);
      masks_[success ? "success" : "failure"].push_back(name);
    }
    if (!recorded.split.empty()) masks_[recorded.split].push_back(name);
    return {};
  }

  void observation(const std::string& group, const std::string& name, const Table& values) {
    file_.write(group + "/obs/" + name, values, precise);
    file_.write(group + "/next_obs/" + name, next_of(values), precise);
  }

  Expected<void> pictures(const RecordedEpisode& recorded, const std::string& camera,
                          const std::string& name, bool next) {
    const Size size = dataset_.cameras.at(camera);
    const auto count = static_cast<std::size_t>(recorded.rows.count);
    file_.begin_bytes(
        name,
        {count, static_cast<std::size_t>(size.height), static_cast<std::size_t>(size.width), 3},
        true);
    std::size_t row = 0;
    auto read = read_rows(recorded, camera, size, [&](const Rgb& picture) -> Expected<void> {
      if (!next || row > 0) file_.add_bytes(picture.bytes);
      if (next && row + 1 == count) file_.add_bytes(picture.bytes);
      ++row;
      return {};
    });
    file_.end_bytes();
    return read;
  }

  /// There is nothing to roll out in: who trains switches that off. robomimic's code reads `type`
  /// (2: an environment in Gym's manner), its description says `env_type`.
  std::string environment() const {
    const Json arguments{{"hand", dataset_.hand}, {"rate", dataset_.rate}};
    return Json{{"env_name", "prehend"}, {"type", 2}, {"env_type", 2}, {"env_kwargs", arguments}}
        .dump();
  }

  const Dataset& dataset_;
  Hdf5File file_;
  Statistics range_;  // of the actions
  std::map<std::string, std::vector<std::string>> masks_;
};

}  // namespace

Expected<void> write_robomimic(const Dataset& dataset, const std::filesystem::path& file,
                               const Written& written) {
  auto created = Hdf5File::create(file);
  if (!created) return tl::unexpected(created.error());
  return RobomimicWriter(dataset, std::move(*created)).write(written);
}

}  // namespace prehend::recorder::dataset
