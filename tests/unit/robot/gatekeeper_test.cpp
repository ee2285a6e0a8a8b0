// What the configuration may ask of the gate before a hand.
#include "common/robot/gatekeeper.hpp"

#include <gtest/gtest.h>

#include "tests/support/domains/domain_lease.hpp"
#include "tests/unit/robot/hand_of_twelve.hpp"

namespace prehend::robot {
namespace {

TEST(Gatekeeper, RefusesAStopAndAButtonThatAreNone) {
  const test::DomainLease lease;
  for (const auto& [setting, message] :
       {std::pair("safety.on_stop=dance", "safety.on_stop: is neither hold nor open"),
        std::pair("safety.button=-1",
                  "safety.button: is no button (1 to 8; 0: none gives consent)")}) {
    const auto shell = service::Shell::create(
        {"--set", "lab.domain=" + std::to_string(lease.domain()), "--set", setting},
        {"robot", "Moves a hand.", {}, false});
    ASSERT_TRUE(shell) << shell.error().message();
    const auto gate = Gatekeeper::create(**shell, hand(), "hand", {});
    ASSERT_FALSE(gate);
    EXPECT_EQ(gate.error().message(), message);
    EXPECT_EQ(gate.error().exit, exit_wrong_use);
  }
}

}  // namespace
}  // namespace prehend::robot
