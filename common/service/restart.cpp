#include "common/service/restart.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/base/error.hpp"
#include "common/base/log.hpp"
#include "common/service/watchdog.hpp"

namespace prehend::service {

void Restart::now() {
  std::vector<char*> arguments;
  for (std::string& text : command_) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  unblock_stop_signals();
  ::close_range(3, ~0u, 0);
  ::execv("/proc/self/exe", arguments.data());
  log::error("cannot start anew: {}", std::strerror(errno));
  std::_Exit(exit_broken);
}

}  // namespace prehend::service
