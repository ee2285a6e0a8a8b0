// The topics between a driver and a controller of ROS 2.
#include "services/robot/devices/nodes.hpp"

#include <gtest/gtest.h>

#include "tests/support/domains/domain_lease.hpp"

namespace prehend::robot {
namespace {

// Every message begins with four bytes that say how it is encoded.
TEST(RobotNodes, WhatIsNoMessageIsNotSent) {
  const test::DomainLease lease;
  const auto nodes = Nodes::join({"arm", lease.domain()}, Nodes::End::driver);
  ASSERT_TRUE(nodes) << nodes.error().message();
  EXPECT_EQ((*nodes)->write("abc").error().what, "a message to nodes could not be sent");
  EXPECT_TRUE((*nodes)->write({"\0\1\0\0", 4}));
}

}  // namespace
}  // namespace prehend::robot
