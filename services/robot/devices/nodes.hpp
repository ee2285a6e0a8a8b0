#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/serial/plug.hpp"
#include "services/robot/devices/channel.hpp"

namespace prehend::robot {

/// One end of the topics between a driver and a controller of ROS 2: joint states the one way, its
/// trajectories the other. Messages are their bytes.
class Nodes {
 public:
  enum class End { driver, controller };
  static Expected<std::unique_ptr<Nodes>> join(const NodesOptions& options, End end);
  ~Nodes();

  /// The oldest message that was not read; waits for one at most that long; empty: none. Of what is
  /// never read the oldest are lost.
  std::string read(Duration timeout);
  Expected<void> write(std::string_view message);

 private:
  struct State;
  explicit Nodes(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Where an emulated controller is plugged in.
Expected<std::unique_ptr<serial::Plug>> plug_into_nodes(const NodesOptions& options);

}  // namespace prehend::robot
