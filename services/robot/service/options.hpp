#pragma once

#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/config.hpp"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

/// The robot that the lab names: its hand, its driver, and where it is connected.
struct Connection {
  std::unique_ptr<model::HandModel> hand;  // the driver keeps a reference to it
  std::unique_ptr<Driver> driver;
  std::string device, port;
  int baud = 0;
};
Expected<Connection> connection_of(const service::Config& config);

}  // namespace prehend::robot
