#include "services/robot/service/options.hpp"

#include <filesystem>
#include <utility>

#include "common/base/file_text.hpp"
#include "common/ros2/nodes/nodes.hpp"

namespace prehend::robot {

Expected<NodesOptions> nodes_of(const service::Config& config) {
  const auto domain = ros2::domain_of_nodes();
  if (!domain) return tl::unexpected(domain.error());
  auto network = ros2::network_of_nodes(config.text("robot.network"));
  if (!network) return tl::unexpected(network.error());
  NodesOptions nodes{config.text("robot.port"), *domain, std::move(*network)};
  if (nodes.controller.starts_with('/')) nodes.controller.erase(0, 1);
  if (nodes.controller.empty()) nodes.controller = "joint_trajectory_controller";
  return nodes;
}

Expected<Connection> connection_of(const service::Config& config) {
  for (const char* key : {"robot.rate", "robot.max_temperature", "robot.lost_after"})
    if (!(config.number(key) > 0)) return wrong_use("must be positive", key);
  if (config.number("robot.rate") > 500) return wrong_use("must be at most 500", "robot.rate");
  const auto kind = find_driver(config.text("robot.device"));
  if (!kind) return tl::unexpected(kind.error());
  Connection connection;
  connection.device = config.text("robot.device");
  connection.port = config.text("robot.port");
  const std::int64_t baud = config.integer("robot.baud");
  if (baud < 0 || baud > 10000000)
    return wrong_use("must be 0 to 10000000 bits per second", "robot.baud",
                     "0 takes the speed that the robot is sold with");
  const int speed = baud == 0 ? (*kind)->baud : static_cast<int>(baud);
  if ((*kind)->medium == Medium::topics) {
    const auto nodes = nodes_of(config);
    if (!nodes) return tl::unexpected(nodes.error());
    connection.port = nodes->controller;
    connection.open = nodes_channel(*nodes);
  } else if (connection.port.empty()) {
    return wrong_use("names no port", "robot.port",
                     "as /dev/ttyUSB0, or the one that `prehend robot emulate` prints");
  } else {
    connection.open = serial_channel(connection.port, speed);
  }
  const std::filesystem::path folder = model::hand_directory(
      (*kind)->hand.empty() ? config.text("mapping.hand") : std::string((*kind)->hand));
  auto hand = model::HandModel::load(folder);
  if (!hand) return tl::unexpected(hand.error());
  const std::int64_t id = config.integer("robot.id");
  if (id < 0 || id > 254) return wrong_use("must be 0 to 254", "robot.id");
  DriverOptions options{.baud = speed,
                        .id = static_cast<int>(id),
                        .rate = config.number("robot.rate"),
                        .max_temperature = config.number("robot.max_temperature"),
                        .lost_after = seconds(config.number("robot.lost_after"))};
  if (!(*kind)->wiring.empty()) {
    std::filesystem::path file = config.path("robot.wiring");
    if (file.empty()) file = folder / (*kind)->wiring;
    const auto text = read_file(file, "give robot.wiring; see services/robot/README.md");
    if (!text) return tl::unexpected(text.error());
    options.wiring = *text;
    options.wiring_file = file.string();
  }
  connection.hand = std::make_unique<model::HandModel>(std::move(*hand));
  auto driver = (*kind)->create(*connection.hand, options);
  if (!driver) return tl::unexpected(driver.error());
  connection.driver = std::move(*driver);
  return connection;
}

}  // namespace prehend::robot
