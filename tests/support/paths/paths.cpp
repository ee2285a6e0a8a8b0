#include "tests/support/paths/paths.hpp"

namespace prehend::test {
namespace {

std::string in(std::string folder, std::string_view path) {
  if (!path.empty()) folder.append("/").append(path);
  return folder;
}

}  // namespace

std::string in_sources(std::string_view path) {
  return in(PREHEND_SOURCE, path);
}

std::string in_programs(std::string_view name) {
  return in(PREHEND_PROGRAMS, name);
}

std::string in_share(std::string_view path) {
  return in(PREHEND_SHARE, path);
}

}  // namespace prehend::test
