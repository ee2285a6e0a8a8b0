#include "common/tool/interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace prehend::tool {
namespace {

volatile std::sig_atomic_t noted = 0;

}  // namespace

void note_interrupts() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    // Who ignores it has been told to by `nohup` and the like.
    if (::sigaction(number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = [](int) { noted = 1; };
    ::sigaction(number, &action, nullptr);
  }
}

bool interrupted() {
  return noted != 0;
}

}  // namespace prehend::tool
