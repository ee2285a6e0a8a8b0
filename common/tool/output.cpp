#include "common/tool/output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <system_error>

#include "common/tool/program.hpp"

namespace prehend::tool {
namespace {

int lost_output(const std::string& why) {
  return complain({"cannot be written: " + why, "standard output",
                   "it is not whole: make room, or write elsewhere"},
                  exit_broken);
}

/// Has a stream of C or of C++ failed, now or before?
bool is_broken() {
  const bool flushed = static_cast<bool>(std::cout.flush());
  return std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !flushed;
}

}  // namespace

int with_whole_output(const std::function<int()>& run) {
  int code = exit_broken;
  try {
    code = run();
  } catch (const std::system_error& error) {
    // fmt throws where it cannot print; whatever else throws is a fault of ours.
    if (!is_broken()) throw;
    return lost_output(error.code().message());
  }
  errno = 0;
  if (!is_broken()) return code;
  // What failed long ago has left no reason.
  return lost_output(errno != 0 ? std::strerror(errno) : "part of it was refused");
}

}  // namespace prehend::tool
