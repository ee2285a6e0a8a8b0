#include "common/base/file_text.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace prehend {

namespace {

struct Close {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using File = std::unique_ptr<std::FILE, Close>;

/// `number` is what errno was when it failed.
tl::unexpected<Error> failed(const char* what, int number, const std::filesystem::path& file,
                             const std::string& hint) {
  return fail(std::string(what) + ": " + std::strerror(number), file.string(), hint);
}

}  // namespace

Expected<std::string> read_file(const std::filesystem::path& file, const std::string& hint) {
  // Not an ifstream: its iterators throw where a read fails, which a folder's does.
  const File stream{std::fopen(file.c_str(), "rbe")};
  if (!stream) return failed("cannot be read", errno, file, hint);
  std::string content;
  char part[65536];
  while (const std::size_t size = std::fread(part, 1, sizeof part, stream.get()))
    content.append(part, size);
  if (std::ferror(stream.get())) return failed("cannot be read", errno, file, hint);
  return content;
}

Expected<void> write_file(const std::filesystem::path& file, std::string_view content,
                          const std::string& hint) {
  const std::filesystem::path beside = file.string() + "." + std::to_string(::getpid());
  File stream{std::fopen(beside.c_str(), "wbe")};
  if (!stream) return failed("cannot be written", errno, file, hint);
  const bool whole = std::fwrite(content.data(), 1, content.size(), stream.get()) == content.size();
  if (std::fclose(stream.release()) == 0 && whole && std::rename(beside.c_str(), file.c_str()) == 0)
    return {};
  const int number = errno;
  std::remove(beside.c_str());
  return failed("cannot be written", number, file, hint);
}

}  // namespace prehend
