#include "common/recording/mcap/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace prehend::recording::mcap {
namespace {

std::string reason() {
  return std::strerror(errno);
}

}  // namespace

File::File(int descriptor, std::uint64_t size, std::string name)
    : descriptor_(descriptor), size_(size), name_(std::move(name)) {}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      size_(std::exchange(other.size_, 0)),
      name_(std::move(other.name_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  std::swap(name_, other.name_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Expected<File> File::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return fail(reason(), path.string());
  File file(descriptor, 0, path.string());
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return fail(reason(), path.string());
  if (!S_ISREG(status.st_mode)) return fail("not a regular file", path.string());
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  return file;
}

Expected<File> File::create(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return fail(reason(), path.string());
  return File(descriptor, 0, path.string());
}

std::string File::at(std::uint64_t offset) const {
  return name_ + " at byte " + std::to_string(offset);
}

void File::expect(std::uint64_t offset, std::uint64_t count) const {
  ::posix_fadvise(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(count),
                  POSIX_FADV_WILLNEED);
}

Expected<Bytes> File::read(std::uint64_t offset, std::uint64_t count) const {
  if (offset > size_ || count > size_ - offset)
    return fail("the file ends before the " + std::to_string(count) + " bytes that belong here",
                at(offset), "cut short? try prehend recording recover");
  Bytes bytes(count);
  std::size_t filled = 0;
  while (filled < count) {
    const ssize_t got = ::pread(descriptor_, bytes.data() + filled, count - filled,
                                static_cast<off_t>(offset + filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(reason(), at(offset));
    if (got == 0) return fail("the file was cut while it was read", at(offset + filled));
    filled += static_cast<std::size_t>(got);
  }
  return bytes;
}

Expected<void> File::write(View bytes) {
  const std::uint64_t before = size_;
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor_, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      const std::string why = reason();
      // Best effort: a tail that cannot be cut off is passed by in reading.
      if (::ftruncate(descriptor_, static_cast<off_t>(before)) == 0)
        ::lseek(descriptor_, static_cast<off_t>(before), SEEK_SET);
      size_ = before;
      return fail(why, name_, "what was written before is whole");
    }
    size_ += static_cast<std::uint64_t>(put);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return {};
}

Expected<void> File::sync() const {
  if (::fsync(descriptor_) != 0) return fail(reason(), name_);
  return {};
}

}  // namespace prehend::recording::mcap
