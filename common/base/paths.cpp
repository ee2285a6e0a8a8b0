#include "common/base/paths.hpp"

#include <cstdlib>
#include <string>

namespace prehend {

std::filesystem::path program_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

std::filesystem::path share_directory() {
  if (const char* given = std::getenv("PREHEND_SHARE")) return given;
  return program_directory().parent_path() / "share" / "prehend";
}

std::filesystem::path state_directory() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (const std::string given = variable("STATE_DIRECTORY"); !given.empty())
    return given.substr(0, given.find(':'));
  if (const std::string given = variable("XDG_STATE_HOME"); !given.empty())
    return std::filesystem::path(given) / "prehend";
  const std::string home = variable("HOME");
  if (home.empty()) return {};
  return std::filesystem::path(home) / ".local" / "state" / "prehend";
}

}  // namespace prehend
