#include "services/recorder/service/snapshot.hpp"

#include <fmt/format.h>

#include <numeric>

namespace prehend::recorder {

Expected<void> check_space(const std::filesystem::path& file, std::uint64_t bytes,
                           std::uint64_t keep_free) {
  std::error_code code;
  const auto space = std::filesystem::space(std::filesystem::absolute(file).parent_path(), code);
  if (code || (space.available >= keep_free && space.available - keep_free >= bytes)) return {};
  return fail(fmt::format("only {} MB are free on the disk", space.available / 1'000'000),
              file.string(), "make room, or lower --keep-free");
}

Expected<Snapshot::Written> Snapshot::write() const {
  if (std::error_code ignored; std::filesystem::exists(path, ignored))
    return fail("is there already", path.string(), "choose another name or remove it");
  const auto sum = [](std::uint64_t all, const KeptSample& one) { return all + one.size(); };
  const std::uint64_t bytes =
      std::accumulate(ring.begin(), ring.end(),
                      std::accumulate(head.begin(), head.end(), std::uint64_t{0}, sum), sum);
  if (const auto room = check_space(path, bytes, keep_free); !room)
    return tl::unexpected(room.error());
  auto written = write_all();
  if (!written) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  return written;
}

Expected<Snapshot::Written> Snapshot::write_all() const {
  auto file = RecordingFile::create(path, *heading, compression);
  if (!file) return tl::unexpected(file.error());
  for (const KeptSample& one : head)
    if (const auto done = file->write(*one.source, *one.sample, start); !done)
      return tl::unexpected(done.error());
  for (const KeptSample& one : ring)
    if (const auto done = file->write(*one.source, *one.sample, one.sample->received); !done)
      return tl::unexpected(done.error());
  if (const auto done = file->write_losses(lost); !done) return tl::unexpected(done.error());
  if (const auto done = file->close(); !done) return tl::unexpected(done.error());
  return Written{path, file->messages(), file->size()};
}

}  // namespace prehend::recorder
