#include "services/recognition/cameras/sources.hpp"
#include "services/recognition/files/picture_file.hpp"

namespace prehend::recognition {
namespace {

class FolderCamera final : public Camera {
 public:
  explicit FolderCamera(std::vector<std::filesystem::path> files) : files_(std::move(files)) {}
  Expected<Picture> next() override { return load_picture(files_[next_++ % files_.size()]); }

 private:
  std::vector<std::filesystem::path> files_;
  std::size_t next_ = 0;
};

}  // namespace

Expected<std::unique_ptr<Camera>> open_folder(const CameraOptions& options) {
  auto files = pictures_in(options.path);
  if (files.empty())
    return fail("no picture in the folder", options.path, "set recognition.path; jpg, png, ...");
  return std::make_unique<FolderCamera>(std::move(files));
}

}  // namespace prehend::recognition
