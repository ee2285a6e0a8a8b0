#pragma once

#include <string>
#include <vector>

namespace prehend::service {

/// Starts the same program with the same arguments in this process, which keeps its number. Where
/// that is not possible the process ends with exit code 3: nothing of it can be used any more.
class Restart {
 public:
  Restart(int argc, char** argv) : command_(argv, argv + argc) {}
  [[noreturn]] void now();

 private:
  std::vector<std::string> command_;
};

}  // namespace prehend::service
