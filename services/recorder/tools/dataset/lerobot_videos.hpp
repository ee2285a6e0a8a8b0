#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "services/recorder/tools/dataset/video_file.hpp"

namespace prehend::recorder::dataset {

/// Of a numbered file in a numbered folder.
struct FilePlace {
  std::int64_t chunk = 0, file = 0;

  static constexpr std::int64_t files = 1000;  // in a folder
  /// chunk-000/file-000
  std::string path() const;
  void advance();
};

/// What H.264 can be of pictures: whole pairs of pixels.
Size even(Size size);

/// Colours of pictures, 0 to 1, of every few pixels of at most 100 rows.
class ColourStatistics {
 public:
  explicit ColourStatistics(Eigen::Index rows) : every_(std::max<Eigen::Index>(1, rows / 100)) {}
  void add(const Rgb& picture);
  Statistics finish() const;

 private:
  Eigen::Index every_, seen_ = 0;
  std::size_t taken_ = 0, pixels_ = 0;
  Eigen::Array3d min_ = Eigen::Array3d::Ones(), max_ = Eigen::Array3d::Zero(),
                 sum_ = Eigen::Array3d::Zero(), squares_ = Eigen::Array3d::Zero();
};

/// Where an episode's pictures are, and what they look like.
struct EpisodeVideo {
  FilePlace place;
  double from = 0, to = 0;  // s, in the file
  Statistics colours;
};

/// The videos of one camera: episodes one behind the other in files of a limited size.
class CameraVideos {
 public:
  CameraVideos(std::filesystem::path folder, std::string camera, Size size, int rate)
      : folder_(std::move(folder)), camera_(std::move(camera)), size_(size), rate_(rate) {}

  Expected<EpisodeVideo> add(const RecordedEpisode& recorded);
  Expected<void> close();

 private:
  std::filesystem::path folder_;
  std::string camera_;
  Size size_;
  int rate_;
  FilePlace place_;
  std::optional<VideoFile> file_;
};

/// An episode's pictures of a camera in a file of their own.
Expected<Statistics> write_video(const RecordedEpisode& recorded, const std::string& camera,
                                 Size size, int rate, const std::filesystem::path& path);

}  // namespace prehend::recorder::dataset
