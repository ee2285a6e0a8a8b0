#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

/// The way to a robot while it is open. Nothing here waits.
class Channel {
 public:
  virtual ~Channel() = default;
  /// What has come next: some bytes, or one message; empty: nothing. Fails when the way is gone.
  virtual Expected<std::string> read() = 0;
  virtual Expected<void> write(std::string_view said) = 0;
  /// The error of a robot that does not answer as it does, with what was heard instead.
  virtual Error unanswered(Error silence) const { return silence; }
};

/// Opens it; asked again after it failed.
using Opener = std::function<Expected<std::unique_ptr<Channel>>()>;

Opener serial_channel(const std::string& port, int baud);

/// Joint states and trajectories of nodes of ROS 2.
struct NodesOptions {
  std::string controller;          // its name, with namespace
  int domain = 0;                  // of DDS, as ROS_DOMAIN_ID
  std::string network = "laptop";  // nodes of this machine; lan: of the network
};
Opener nodes_channel(const NodesOptions& options);

}  // namespace prehend::robot
