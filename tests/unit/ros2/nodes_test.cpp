// How nodes are reached, as their own variable says it where the configuration does not.
#include "common/ros2/nodes/nodes.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "common/dds/network.hpp"

namespace prehend::ros2 {
namespace {

class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  ~Variable() { ::unsetenv(name_); }

 private:
  const char* name_;
};

class Range : Variable {
 public:
  explicit Range(const char* value) : Variable("ROS_AUTOMATIC_DISCOVERY_RANGE", value) {}
};

TEST(NetworkOfNodes, IsWhatIsSaidElseTheirRange) {
  EXPECT_EQ(network_of_nodes("").value(), "laptop");
  EXPECT_FALSE(network_of_nodes("moon"));
  for (const auto& [range, network] : {std::pair("SUBNET", "lan"),
                                       {"LOCALHOST", "laptop"},
                                       {"SYSTEM_DEFAULT", "laptop"},
                                       {"subnet", "laptop"},
                                       {"", "laptop"}}) {
    const Range set(range);
    EXPECT_EQ(network_of_nodes("").value(), network) << range;
    EXPECT_EQ(network_of_nodes("laptop").value(), "laptop") << range;
    EXPECT_EQ(network_of_nodes("lan").value(), "lan") << range;
  }
  // No variable lets others lead; and nobody does whom a lab with keys does not know.
  {
    const Range set("SUBNET");
    EXPECT_EQ(network_of_leaders("", false).value(), "laptop");
    EXPECT_EQ(network_of_leaders("lan", false).value(), "lan");
    EXPECT_FALSE(network_of_leaders("lan", true));
    EXPECT_EQ(network_of_leaders("laptop", true).value(), "laptop");
  }
  const Range off("OFF");
  EXPECT_FALSE(network_of_nodes(""));
  EXPECT_EQ(network_of_nodes("lan").value(), "lan");
}

TEST(HostsOfNodes, AreThoseOfTheirListWhereTheNetworkIsTold) {
  EXPECT_TRUE(hosts_of_nodes("lan").empty());
  const Variable set("ROS_STATIC_PEERS", ";192.0.2.7;;robot.example;");
  EXPECT_EQ(hosts_of_nodes("lan"), (std::vector<std::string>{"192.0.2.7", "robot.example"}));
  EXPECT_TRUE(hosts_of_nodes("laptop").empty());
}

// Hosts that are named are asked beside the group, not instead of it.
TEST(HostsOfNodes, AreAskedBesideTheGroup) {
  const auto qos = dds::participant_qos({.profile = "lan", .hosts = {"192.0.2.7"}});
  ASSERT_TRUE(qos) << qos.error().message();
  std::vector<std::string> asked;
  for (const auto& locator : qos->wire_protocol().builtin.initialPeersList)
    asked.push_back(dds::rtps::IPLocator::toIPv4string(locator));
  EXPECT_EQ(asked, (std::vector<std::string>{"239.255.0.1", "192.0.2.7"}));
  const auto alone = dds::participant_qos({.profile = "lan"});
  ASSERT_TRUE(alone);
  EXPECT_TRUE(alone->wire_protocol().builtin.initialPeersList.empty());
  EXPECT_FALSE(dds::participant_qos({.profile = "lan", .hosts = {"192.0.2.7:7400"}}));
}

}  // namespace
}  // namespace prehend::ros2
