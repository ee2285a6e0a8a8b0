#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "services/recorder/tools/dataset/hdf5_file.hpp"
#include "services/recorder/tools/dataset/layouts.hpp"
#include "services/recorder/tools/dataset/pictures.hpp"

// [Zhao2023]; the layout: record_episodes.py of https://github.com/tonyzhaozh/aloha
namespace prehend::recorder::dataset {
namespace {

constexpr auto precision = Hdf5File::Precision::single;

/// Pictures as they were compressed, each row filled up with zeros to the longest. Returns their
/// true lengths.
Expected<std::vector<double>> compressed(const RecordedEpisode& recorded, const std::string& camera,
                                         Hdf5File& file) {
  std::map<std::size_t, std::vector<std::uint8_t>> pictures;  // by place
  std::size_t longest = 1;
  auto read =
      read_pictures(recorded, camera, [&](std::size_t place, std::vector<std::uint8_t> bytes) {
        longest = std::max(longest, bytes.size());
        pictures[place] = std::move(bytes);
        return Expected<void>();
      });
  if (!read) return tl::unexpected(read.error());
  if (pictures.empty()) return fail("no picture of " + camera, recorded.file.string());
  const auto& places = recorded.rows.pictures.at(camera);
  std::vector<double> lengths;
  file.begin_bytes("/observations/images/" + camera, {places.size(), longest}, false);
  for (const std::size_t place : places) {
    // The one before, where this one could not be read.
    auto found = pictures.upper_bound(place);
    if (found != pictures.begin()) --found;
    std::vector<std::uint8_t> row = found->second;
    lengths.push_back(static_cast<double>(row.size()));
    row.resize(longest);
    file.add_bytes(row);
  }
  file.end_bytes();
  return lengths;
}

Expected<void> decoded(const RecordedEpisode& recorded, const std::string& camera, Size size,
                       Hdf5File& file) {
  file.begin_bytes("/observations/images/" + camera,
                   {static_cast<std::size_t>(recorded.rows.count),
                    static_cast<std::size_t>(size.height), static_cast<std::size_t>(size.width), 3},
                   false);
  auto read = read_rows(recorded, camera, size, [&](const Rgb& picture) {
    file.add_bytes(picture.bytes);
    return Expected<void>();
  });
  file.end_bytes();
  return read;
}

Expected<void> write_pictures(const Dataset& dataset, const RecordedEpisode& recorded,
                              Hdf5File& file) {
  Table lengths(static_cast<Eigen::Index>(dataset.cameras.size()), recorded.rows.count);
  Eigen::Index camera = 0;
  for (const auto& [name, size] : dataset.cameras) {
    if (dataset.sized) {
      if (auto done = decoded(recorded, name, size, file); !done) return done;
      continue;
    }
    const auto lengths_of_camera = compressed(recorded, name, file);
    if (!lengths_of_camera) return tl::unexpected(lengths_of_camera.error());
    lengths.row(camera++) =
        Eigen::Map<const Eigen::RowVectorXd>(lengths_of_camera->data(), recorded.rows.count);
  }
  if (!dataset.sized && !dataset.cameras.empty()) file.write("/compress_len", lengths, precision);
  return {};
}

Expected<void> write_episode(const Dataset& dataset, const RecordedEpisode& recorded,
                             const std::filesystem::path& path) {
  auto file = Hdf5File::create(path);
  if (!file) return tl::unexpected(file.error());
  const Rows& rows = recorded.rows;
  file->write("/observations/qpos", rows.state.values, precision);
  file->write("/observations/qvel", rows.rate, precision);
  if (rows.effort.cols() > 0) file->write("/observations/effort", rows.effort, precision);
  for (const Feature& feature : rows.others)
    file->write("/observations/" + feature.name, feature.values, precision);
  file->write("/action", rows.action.values, precision);
  if (auto done = write_pictures(dataset, recorded, *file); !done) return done;
  file->attribute("/", "sim", recorded.simulated);
  file->attribute("/", "compress", !dataset.sized && !dataset.cameras.empty());
  file->attribute("/", "columns", fmt::format("{}", fmt::join(rows.state.columns, ",")));
  file->attribute("/", "task", recorded.episode.task);
  file->attribute("/", "recording", recorded.file.filename().string());
  file->attribute("/", "begin_ns", static_cast<std::int64_t>(to_ns(rows.begin)));
  file->attribute("/", "rate", Eigen::VectorXd::Constant(1, dataset.rate));
  if (!recorded.split.empty()) file->attribute("/", "split", recorded.split);
  if (recorded.episode.success) file->attribute("/", "success", *recorded.episode.success);
  return file->close();
}

}  // namespace

Expected<void> write_aloha(const Dataset& dataset, const std::filesystem::path& folder,
                           const Written& written) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) return fail(problem.message(), folder.string());
  for (std::size_t i = 0; i < dataset.episodes.size(); ++i) {
    const auto path = folder / fmt::format("episode_{}.hdf5", i);
    if (auto done = write_episode(dataset, dataset.episodes[i], path); !done) return done;
    written();
  }
  return {};
}

}  // namespace prehend::recorder::dataset
