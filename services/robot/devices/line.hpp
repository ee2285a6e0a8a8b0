#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/serial/serial_port.hpp"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

/// Carries what driver and robot say to each other over a serial port. A port that is missing is
/// tried again; nothing here waits, so that a tick may call it.
class Line {
 public:
  Line(Driver& driver, std::string port, int baud);
  /// Lets the robot stop what it does.
  ~Line();
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  void exchange(Time now);

 private:
  void lose(const Error& error, Time now);

  Driver& driver_;
  std::string port_name_;
  int baud_;
  std::optional<serial::SerialPort> port_;
  Time next_try_{};
};

/// Exchanges until the driver says so, or the time is over: for tools, which have nothing else to
/// do. False: in vain.
bool exchange_until(Line& line, Duration longest, const std::function<bool()>& done);

}  // namespace prehend::robot
