#include "common/serial/pseudo_terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace prehend::serial {

Expected<PseudoTerminal> PseudoTerminal::open(const std::filesystem::path& link) {
  PseudoTerminal made;
  made.master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> name{};
  if (made.master_ < 0 || ::grantpt(made.master_) != 0 || ::unlockpt(made.master_) != 0 ||
      ::ptsname_r(made.master_, name.data(), name.size()) != 0)
    return fail(std::string("no pseudo-terminal: ") + std::strerror(errno), "/dev/ptmx");
  made.path_ = name.data();
  made.slave_ = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (made.slave_ < 0 || ::tcgetattr(made.slave_, &settings) != 0)
    return fail(std::strerror(errno), made.path_);
  ::cfmakeraw(&settings);  // or the terminal would echo and translate
  ::tcsetattr(made.slave_, TCSANOW, &settings);

  if (!link.empty()) {
    std::error_code error;
    if (std::filesystem::is_symlink(link, error)) std::filesystem::remove(link, error);
    std::filesystem::create_symlink(made.path_, link, error);
    if (error) return fail(error.message(), link.string(), "name a link in a folder of yours");
    made.link_ = link;
  }
  return made;
}

PseudoTerminal::PseudoTerminal(PseudoTerminal&& other) noexcept
    : master_(std::exchange(other.master_, -1)),
      slave_(std::exchange(other.slave_, -1)),
      path_(std::move(other.path_)),
      link_(std::exchange(other.link_, {})) {}

PseudoTerminal::~PseudoTerminal() {
  std::error_code error;
  // Not if another one has taken the link over.
  if (!link_.empty() && std::filesystem::read_symlink(link_, error) == path_)
    std::filesystem::remove(link_, error);
  if (slave_ >= 0) ::close(slave_);
  if (master_ >= 0) ::close(master_);
}

std::string PseudoTerminal::read(Duration timeout) {
  using std::chrono::milliseconds;
  pollfd ready{master_, POLLIN, 0};
  const timespec wait{std::max<std::int64_t>(0, timeout.count()) / 1000000000,
                      std::max<std::int64_t>(0, timeout.count()) % 1000000000};
  if (::ppoll(&ready, 1, &wait, nullptr) <= 0) return {};
  std::array<char, 1024> bytes;
  const ssize_t count = ::read(master_, bytes.data(), bytes.size());
  return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : std::string();
}

void PseudoTerminal::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(master_, bytes.data(), bytes.size());
    if (count <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace prehend::serial
