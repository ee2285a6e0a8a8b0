#include "common/serial/serial_port.hpp"

#include <fcntl.h>
#include <libserialport.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace prehend::serial {
namespace {

std::string last_error() {
  char* message = sp_last_error_message();
  std::string text = message ? message : "no reason given";
  sp_free_error_message(message);
  return text;
}

/// True when it became ready; false after the timeout or a signal.
bool wait_for(int handle, short events, Duration timeout, short& seen) {
  using std::chrono::milliseconds;
  const auto wait = std::chrono::ceil<milliseconds>(std::max(timeout, Duration::zero())).count();
  pollfd ready{handle, events, 0};
  const bool any = ::poll(&ready, 1, static_cast<int>(wait)) > 0;
  seen = ready.revents;
  return any;
}

bool is_pseudo_terminal(const std::string& real) {
  return real.starts_with("/dev/pts/");
}

}  // namespace

Expected<SerialPort> SerialPort::open(const std::string& path, int baud) {
  const std::string hint =
      "check the name of the port, the cable, and the right to use it (group dialout)";
  // The library knows ports by their place in /dev, not by links to it.
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  if (error) return fail("there is no such port", path, hint);
  SerialPort made(path);
  if (auto opened = made.open_real(real.string(), baud, hint); !opened)
    return tl::unexpected(opened.error());
  // Two programs would each hear half of what comes.
  if (::flock(made.handle_, LOCK_EX | LOCK_NB) != 0)
    return fail("another program uses the port", path, "end that one first");
  return made;
}

Expected<void> SerialPort::open_real(const std::string& real, int baud, const std::string& hint) {
  if (is_pseudo_terminal(real)) {
    handle_ = ::open(real.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    termios settings{};
    if (handle_ < 0 || ::tcgetattr(handle_, &settings) != 0)
      return fail(std::strerror(errno), path_, hint);
    ::cfmakeraw(&settings);
    ::tcsetattr(handle_, TCSANOW, &settings);
    return {};
  }
  if (sp_get_port_by_name(real.c_str(), &port_) != SP_OK)
    return fail("this is not a serial port", path_, hint);
  if (sp_open(port_, SP_MODE_READ_WRITE) != SP_OK)
    return fail("the port cannot be opened: " + last_error(), path_, hint);
  if (sp_set_baudrate(port_, baud) != SP_OK || sp_set_bits(port_, 8) != SP_OK ||
      sp_set_parity(port_, SP_PARITY_NONE) != SP_OK || sp_set_stopbits(port_, 1) != SP_OK ||
      sp_set_flowcontrol(port_, SP_FLOWCONTROL_NONE) != SP_OK)
    return fail("the port cannot be set up: " + last_error(), path_, "check the baud rate");
  // These trackers take a raised RTS for a reset that lasts.
  sp_set_rts(port_, SP_RTS_OFF);
  if (sp_get_port_handle(port_, &handle_) != SP_OK)
    return fail("the port has no handle: " + last_error(), path_, hint);
  return {};
}

SerialPort::SerialPort(SerialPort&& other) noexcept
    : path_(std::move(other.path_)),
      overheard_(std::move(other.overheard_)),
      handle_(std::exchange(other.handle_, -1)),
      port_(std::exchange(other.port_, nullptr)) {}

SerialPort::~SerialPort() {
  if (port_) {
    sp_close(port_);
    sp_free_port(port_);
  } else if (handle_ >= 0) {
    ::close(handle_);
  }
}

Expected<std::string> SerialPort::read(Duration timeout) {
  short events = 0;
  if (!wait_for(handle_, POLLIN, timeout, events)) return std::string();
  if ((events & POLLIN) != 0) {
    std::array<char, 4096> bytes;
    const ssize_t count = ::read(handle_, bytes.data(), bytes.size());
    if (count > 0) {
      std::string heard(bytes.data(), static_cast<std::size_t>(count));
      overheard_.heard(heard);
      return heard;
    }
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::string();
  }
  // Ready, but without a byte: the other end hung up or the adapter was pulled out.
  return fail("the port has disappeared", path_, "reconnects by itself when it returns");
}

Expected<void> SerialPort::write(std::string_view bytes) {
  overheard_.said(bytes);
  while (!bytes.empty()) {
    short events = 0;
    ssize_t count = -1;
    if (wait_for(handle_, POLLOUT, std::chrono::milliseconds(200), events))
      count = ::write(handle_, bytes.data(), bytes.size());
    if (count <= 0)
      return fail("the port takes no bytes", path_, "reconnects by itself when it does");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

void SerialPort::discard_input() {
  ::tcflush(handle_, TCIFLUSH);
}

}  // namespace prehend::serial
