#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "services/robot/core/driver.hpp"
#include "services/robot/devices/channel.hpp"

namespace prehend::robot {

/// Carries what driver and robot say to each other over a channel. One that is missing is tried
/// again; nothing here waits, so that a tick may call it.
class Line {
 public:
  Line(Driver& driver, Opener open);
  /// Lets the robot stop what it does.
  ~Line();
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  void exchange(Time now);
  /// What is wrong: of a robot that is offline, also what was heard instead of it. `hint` is for a
  /// silent one.
  Error trouble(const std::string& where = {}, const std::string& hint = {}) const;

 private:
  void lose(const Error& error, Time now);

  Driver& driver_;
  Opener open_;
  std::unique_ptr<Channel> channel_;  // none: it is tried again
  Time next_try_{};
  std::optional<Time> first_heard_;  // since it was opened
  bool hears_ = false;               // long enough to be quoted
};

/// Exchanges until the driver says so, or the time is over: for tools, which have nothing else to
/// do. False: in vain.
bool exchange_until(Line& line, Duration longest, const std::function<bool()>& done);

}  // namespace prehend::robot
