// How nodes are reached, as their own variable says it where the configuration does not.
#include "common/ros2/nodes/nodes.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace prehend::ros2 {
namespace {

class Range {
 public:
  explicit Range(const char* value) { ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", value, 1); }
  ~Range() { ::unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE"); }
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

}  // namespace
}  // namespace prehend::ros2
