#include "services/recorder/tools/dataset/lerobot_videos.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace prehend::recorder::dataset {
namespace {

constexpr std::uintmax_t max_video_bytes = 200u << 20;
constexpr int pixel_step = 4;

Expected<VideoFile> begin(const std::filesystem::path& path, Size size, int rate) {
  std::error_code problem;
  std::filesystem::create_directories(path.parent_path(), problem);
  if (problem) return fail(problem.message(), path.parent_path().string());
  return VideoFile::create(path, size, rate);
}

Expected<Statistics> encode(const RecordedEpisode& recorded, const std::string& camera, Size size,
                            VideoFile& file) {
  ColourStatistics colours(recorded.rows.count);
  auto read = read_rows(recorded, camera, size, [&](const Rgb& picture) {
    colours.add(picture);
    return file.add(picture);
  });
  if (!read) return tl::unexpected(read.error());
  return colours.finish();
}

}  // namespace

std::string FilePlace::path() const {
  return fmt::format("chunk-{:03d}/file-{:03d}", chunk, file);
}

void FilePlace::advance() {
  if (++file < files) return;
  file = 0;
  ++chunk;
}

Size even(Size size) {
  return {std::max(2, size.width / 2 * 2), std::max(2, size.height / 2 * 2)};
}

void ColourStatistics::add(const Rgb& picture) {
  if (seen_++ % every_ != 0) return;
  ++taken_;
  for (int y = 0; y < picture.size.height; y += pixel_step) {
    for (int x = 0; x < picture.size.width; x += pixel_step) {
      const std::size_t place =
          3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.size.width) +
               static_cast<std::size_t>(x));
      const Eigen::Array3d colour =
          Eigen::Array3d(picture.bytes[place], picture.bytes[place + 1], picture.bytes[place + 2]) /
          255;
      min_ = min_.min(colour);
      max_ = max_.max(colour);
      sum_ += colour;
      squares_ += colour.square();
      ++pixels_;
    }
  }
}

Statistics ColourStatistics::finish() const {
  const double count = static_cast<double>(std::max<std::size_t>(1, pixels_));
  const Eigen::Array3d mean = sum_ / count;
  return {min_, max_, mean, (squares_ / count - mean.square()).max(0).sqrt(), taken_};
}

Expected<EpisodeVideo> CameraVideos::add(const RecordedEpisode& recorded) {
  const auto path = folder_ / (place_.path() + ".mp4");
  if (!file_) {
    auto begun = begin(path, size_, rate_);
    if (!begun) return tl::unexpected(begun.error());
    file_ = std::move(*begun);
  }
  const auto time = [&] { return static_cast<double>(file_->frames()) / rate_; };
  EpisodeVideo video{place_, time(), 0, {}};
  auto colours = encode(recorded, camera_, size_, *file_);
  if (!colours) return tl::unexpected(colours.error());
  video.colours = std::move(*colours);
  video.to = time();
  std::error_code problem;
  if (std::filesystem::file_size(path, problem) >= max_video_bytes && !problem) {
    if (auto closed = close(); !closed) return tl::unexpected(closed.error());
    place_.advance();
  }
  return video;
}

Expected<void> CameraVideos::close() {
  if (!file_) return {};
  auto closed = file_->close();
  file_.reset();
  return closed;
}

Expected<Statistics> write_video(const RecordedEpisode& recorded, const std::string& camera,
                                 Size size, int rate, const std::filesystem::path& path) {
  auto file = begin(path, size, rate);
  if (!file) return tl::unexpected(file.error());
  auto colours = encode(recorded, camera, size, *file);
  if (!colours) return colours;
  if (auto closed = file->close(); !closed) return tl::unexpected(closed.error());
  return colours;
}

}  // namespace prehend::recorder::dataset
