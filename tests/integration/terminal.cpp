#include "tests/integration/terminal.hpp"

#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>

namespace prehend::integration {

Terminal::Terminal(const std::string& program, const Strings& arguments) {
  std::vector<char*> pointers{const_cast<char*>(program.c_str())};
  for (const std::string& each : arguments) pointers.push_back(const_cast<char*>(each.c_str()));
  pointers.push_back(nullptr);
  pid_ = ::forkpty(&descriptor_, nullptr, nullptr, nullptr);
  if (pid_ == 0) {
    ::execv(program.c_str(), pointers.data());
    ::_exit(127);
  }
}

Terminal::~Terminal() {
  if (!ended_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  ::close(descriptor_);
}

void Terminal::press(const std::string& keys) {
  EXPECT_EQ(::write(descriptor_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
}

bool Terminal::shows(const std::string& text) {
  return eventually(20, [&] {
    take();
    const auto at = shown_.find(text);
    if (at == std::string::npos) return false;
    shown_.erase(0, at + text.size());
    return true;
  });
}

int Terminal::end() {
  int status = 0;
  ended_ = eventually(20, [&] {
    take();  // a terminal that nobody reads would hold it up
    return ::waitpid(pid_, &status, WNOHANG) == pid_;
  });
  return ended_ && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool Terminal::is_a_shells() const {
  termios now{};
  return ::tcgetattr(descriptor_, &now) == 0 && (now.c_lflag & ICANON) != 0 &&
         (now.c_lflag & ECHO) != 0;
}

void Terminal::take() {
  pollfd input{descriptor_, POLLIN, 0};
  char bytes[4096];
  while (::poll(&input, 1, 0) == 1 && (input.revents & POLLIN) != 0) {
    const ssize_t count = ::read(descriptor_, bytes, sizeof bytes);
    if (count <= 0) return;
    shown_.append(bytes, static_cast<std::size_t>(count));
  }
}

}  // namespace prehend::integration
