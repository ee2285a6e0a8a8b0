// What the configuration may not say of a robot is refused by the name of its key.
#include "services/robot/service/options.hpp"

#include <gtest/gtest.h>

#include "tests/support/paths/paths.hpp"

namespace prehend::robot {
namespace {

std::string robot_said(const std::string& setting) {
  const auto robot =
      service::Config::load(test::in_sources("deploy/lab.toml"), {"robot.port=/dev/null", setting})
          .and_then(connection_of);
  return robot ? "taken" : robot.error().message();
}

TEST(RobotOptions, AreRefusedByTheirKeys) {
  const std::string baud =
      "robot.baud: must be 0 to 10000000 bits per second (0 takes the speed that the robot is sold "
      "with)";
  for (const auto& [setting, words] :
       {std::pair<std::string, std::string>("robot.rate=500", "taken"),
        {"robot.rate=501", "robot.rate: must be at most 500"},
        {"robot.rate=0", "robot.rate: must be positive"},
        {"robot.max_temperature=-1", "robot.max_temperature: must be positive"},
        {"robot.lost_after=0", "robot.lost_after: must be positive"},
        {"robot.baud=-1", baud},
        {"robot.baud=10000001", baud},
        {"robot.id=-1", "robot.id: must be 0 to 254"},
        {"robot.id=255", "robot.id: must be 0 to 254"}})
    EXPECT_EQ(robot_said(setting), words) << setting;
}

}  // namespace
}  // namespace prehend::robot
