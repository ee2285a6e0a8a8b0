#pragma once

#include <functional>
#include <string>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/time.hpp"

namespace prehend::glove {

/// A thread that opens its port, uses it, and when that fails tries again every 0.2 s, for ever:
/// cables are pulled out and plugged in.
class Persistent {
 public:
  /// One life of the port, until the stop or until it fails.
  using Life = std::function<Expected<void>(const std::stop_token&)>;

  /// `complain` gets a line when what is wrong changes. Called once.
  void start(Life life, std::function<void(std::string)> complain);
  /// From within a life: all is well, so that the next complaint is news, even if it is the last
  /// one once more.
  void well() { said_.clear(); }
  /// Sleeps, but not longer than until the stop.
  static void pause(const std::stop_token& stop, Duration duration);

 private:
  std::string said_;
  std::jthread thread_;  // last: joined before the rest goes
};

}  // namespace prehend::glove
