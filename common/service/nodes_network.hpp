#pragma once

#include <string>

#include "common/base/error.hpp"
#include "common/service/config.hpp"

namespace prehend::service {

/// By ros.network, where nodes of ROS 2 are heard that lead a hand or say what is seen: laptop or
/// lan. Refused: another word, and lan in a lab with keys, since anybody may be a node there.
Expected<std::string> network_of_nodes(const Config& config);

}  // namespace prehend::service
