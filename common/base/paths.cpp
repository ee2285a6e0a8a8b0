#include "common/base/paths.hpp"

#include <cstdlib>
#include <string>

namespace prehend {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// prehend in the folder that the variable names, else in that of the user's home.
std::filesystem::path own_folder(const char* name, const char* otherwise) {
  if (const std::string given = variable(name); !given.empty())
    return std::filesystem::path(given) / "prehend";
  const std::string home = variable("HOME");
  if (home.empty()) return {};
  return std::filesystem::path(home) / ".local" / otherwise / "prehend";
}

}  // namespace

std::filesystem::path program_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

std::filesystem::path share_directory() {
  if (const char* given = std::getenv("PREHEND_SHARE")) return given;
  return program_directory().parent_path() / "share" / "prehend";
}

std::filesystem::path state_directory() {
  if (const std::string given = variable("STATE_DIRECTORY"); !given.empty())
    return given.substr(0, given.find(':'));
  return own_folder("XDG_STATE_HOME", "state");
}

std::filesystem::path data_directory() {
  return own_folder("XDG_DATA_HOME", "share");
}

}  // namespace prehend
