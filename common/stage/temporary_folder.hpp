#pragma once

#include <filesystem>
#include <utility>

#include "common/base/error.hpp"

namespace prehend::stage {

/// A folder under the system's temporary one, removed at the end unless it shall be kept.
class TemporaryFolder {
 public:
  static Expected<TemporaryFolder> create(bool keep);
  TemporaryFolder(TemporaryFolder&& other) noexcept;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::filesystem::path path, bool keep)
      : path_(std::move(path)), keep_(keep) {}
  std::filesystem::path path_;
  bool keep_;
};

}  // namespace prehend::stage
