#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "common/recording/mcap/bytes.hpp"

namespace prehend::recording::mcap {

/// Owner of an open file.
class File {
 public:
  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  /// For reading; fails on anything but a regular file.
  static Expected<File> open(const std::filesystem::path& path);
  /// For writing; what was there is gone.
  static Expected<File> create(const std::filesystem::path& path);

  /// Size when it was opened: a file that still grows is read as it was then.
  std::uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }
  /// «file at byte N», for messages.
  std::string at(std::uint64_t offset) const;

  /// Tells the system what will be read soon, so that it fetches many places at once.
  void expect(std::uint64_t offset, std::uint64_t count) const;
  /// Exactly these bytes; fails when they are not all there.
  Expected<Bytes> read(std::uint64_t offset, std::uint64_t count) const;
  /// Behind what was written so far. On failure (a full disk) the file is cut back to where it was.
  Expected<void> write(View bytes);
  /// Waits until all is on the disk.
  Expected<void> sync() const;

 private:
  File(int descriptor, std::uint64_t size, std::string name);

  int descriptor_;
  std::uint64_t size_;
  std::string name_;
};

}  // namespace prehend::recording::mcap
