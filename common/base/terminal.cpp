#include "common/base/terminal.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace prehend {

bool has_cursor(int file) {
  if (::isatty(file) == 0) return false;
  const char* kind = std::getenv("TERM");
  return !kind || std::string_view(kind) != "dumb";
}

}  // namespace prehend
