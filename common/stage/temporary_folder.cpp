#include "common/stage/temporary_folder.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

namespace prehend::stage {

Expected<TemporaryFolder> TemporaryFolder::create(bool keep) {
  std::error_code code;
  const std::filesystem::path base = std::filesystem::temp_directory_path(code);
  if (code) return fail(code.message(), "temporary folder", "set TMPDIR");
  std::string name = (base / "prehend-XXXXXX").string();
  if (!::mkdtemp(name.data())) return fail("cannot make a folder", base.string(), "set TMPDIR");
  return TemporaryFolder(name, keep);
}

TemporaryFolder::TemporaryFolder(TemporaryFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), keep_(other.keep_) {}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!keep_ && !path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace prehend::stage
