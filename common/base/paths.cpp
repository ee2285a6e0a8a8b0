#include "common/base/paths.hpp"

#include <cstdlib>

namespace prehend {

std::filesystem::path program_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

std::filesystem::path share_directory() {
  if (const char* given = std::getenv("PREHEND_SHARE")) return given;
  return program_directory().parent_path() / "share" / "prehend";
}

}  // namespace prehend
