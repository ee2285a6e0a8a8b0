#include "common/service/nodes_network.hpp"

#include "common/ros2/nodes/nodes.hpp"

namespace prehend::service {

Expected<std::string> network_of_nodes(const Config& config) {
  auto network = ros2::network_of_nodes(config.text("ros.network"));
  if (!network) return network;
  if (*network == "lan" && !config.path("lab.keys").empty())
    return wrong_use("would let anybody on the network lead a hand that has keys", "ros.network",
                     "laptop: nodes of this machine alone");
  return network;
}

}  // namespace prehend::service
