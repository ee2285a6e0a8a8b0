#pragma once

#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/config.hpp"
#include "services/robot/core/driver.hpp"
#include "services/robot/devices/channel.hpp"

namespace prehend::robot {

/// Where nodes of ROS 2 meet, as the lab and ROS_DOMAIN_ID say.
Expected<NodesOptions> nodes_of(const service::Config& config);

/// The robot that the lab names: its hand, its driver, and where it is connected.
struct Connection {
  std::unique_ptr<model::HandModel> hand;  // the driver keeps a reference to it
  std::unique_ptr<Driver> driver;
  std::string device;
  std::string port;  // where it is: a path, or the name of a controller of ROS 2
  Opener open;
};
Expected<Connection> connection_of(const service::Config& config);

}  // namespace prehend::robot
