#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"

/// Where nodes of ROS 2 meet: a domain of DDS, without partition, and topics with a name before
/// their name.
namespace prehend::ros2 {

/// Of ROS_DOMAIN_ID, as nodes take it: 0 where nothing is said. Else 0 to 232.
Expected<int> domain_of_nodes();

/// How they are reached: laptop (nodes of this machine) or lan (of the network). said: in a
/// configuration; empty: as ROS_AUTOMATIC_DISCOVERY_RANGE has it, where a word that it does not
/// know is LOCALHOST, and laptop where nothing is said. Fails on other words, and on OFF.
Expected<std::string> network_of_nodes(const std::string& said);

/// The same, of nodes that lead a hand or say what is seen; here no variable opens the network, so
/// empty is laptop. Refused: lan in a lab with keys (`secured`), since anybody may be a node there.
Expected<std::string> network_of_leaders(const std::string& said, bool secured);

/// The hosts of ROS_STATIC_PEERS, a list with ; between them, that are to be asked beside those
/// that multicast reaches. Only for what is told to nodes: no variable lets others lead. On a
/// laptop none, and a line in the log says so.
std::vector<std::string> hosts_of_nodes(const std::string& network);

/// network: laptop (nodes of this machine) or lan (of the network); hosts: that are asked there as
/// well. Fails when one of them has no such name.
Expected<dds::Participant> join_nodes(const std::string& name, int domain,
                                      const std::string& network,
                                      const std::vector<std::string>& hosts = {});

/// The topic /name of nodes. type: as «sensor_msgs/JointState». kept: who comes late gets the
/// last one. Readers and writers of nodes match it.
dds::RawTopic topic_of_nodes(const std::string& name, const std::string& type, bool kept = false);

}  // namespace prehend::ros2
