#include "common/service/nodes_network.hpp"

namespace prehend::service {

Expected<std::string> network_of_nodes(const Config& config) {
  const std::string& network = config.text("ros.network");
  if (network != "laptop" && network != "lan")
    return wrong_use("is neither laptop nor lan", "ros.network");
  if (network == "lan" && !config.path("lab.keys").empty())
    return wrong_use("would let anybody on the network lead a hand that has keys", "ros.network",
                     "laptop: nodes of this machine alone");
  return network;
}

}  // namespace prehend::service
