#pragma once

#include <filesystem>
#include <memory>

#include "common/base/error.hpp"
#include "services/recorder/tools/dataset/pictures.hpp"

namespace prehend::recorder::dataset {

/// An mp4 file of pictures at a constant rate: H.264 without frames that need later ones, and with
/// a whole picture at least every second frame, so that a trainer may jump anywhere.
class VideoFile {
 public:
  /// Width and height are even.
  static Expected<VideoFile> create(const std::filesystem::path& path, Size size, int rate);
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;
  ~VideoFile();

  /// Of the file's size.
  Expected<void> add(const Rgb& picture);
  /// Without it the file is not whole.
  Expected<void> close();

  std::size_t frames() const;

  struct State;

 private:
  explicit VideoFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::recorder::dataset
