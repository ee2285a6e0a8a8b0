#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/serial/overheard.hpp"

struct sp_port;

namespace prehend::serial {

/// A serial line, 8 bits, no parity, 1 stop bit, no flow control. Not for several threads at once.
///
/// Opened and set up by libserialport. It refuses pseudo-terminals (version 0.1.1 insists on modem
/// lines, TIOCMGET), so these are opened here; what is read and written goes the same way.
class SerialPort {
 public:
  /// `path` may be a link. Refuses a port that another program uses in this way.
  static Expected<SerialPort> open(const std::string& path, int baud);
  SerialPort(SerialPort&& other) noexcept;
  SerialPort& operator=(SerialPort&&) = delete;
  ~SerialPort();

  /// What has come, as soon as anything has; empty when nothing came in time. Fails when the port
  /// is gone.
  Expected<std::string> read(Duration timeout);
  Expected<void> write(std::string_view bytes);
  /// Throws away what has come and was not read.
  void discard_input();
  /// What was read and written since it was opened.
  const Overheard& overheard() const { return overheard_; }

 private:
  explicit SerialPort(std::string path) : path_(std::move(path)) {}
  Expected<void> open_real(const std::string& real, int baud, const std::string& hint);

  std::string path_;
  Overheard overheard_;
  int handle_ = -1;
  sp_port* port_ = nullptr;  // owns the handle; null: a pseudo-terminal, the handle is ours
};

}  // namespace prehend::serial
