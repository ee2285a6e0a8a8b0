// What is told to nodes of ROS 2 begins with where the camera is.
#include "services/ros/service/teller.hpp"

#include <gtest/gtest.h>

#include "tests/support/paths/paths.hpp"

namespace prehend::ros {
namespace {

TEST(Teller, NeedsThePoseOfTheCamera) {
  for (const auto& [pose, words] :
       {std::pair("[0, 0, 0]",
                  "camera.X_WC: needs seven numbers: x y z in m, then the quaternion w x y z"),
        {"[1, 1, 1, 0, 0, 0, 0]", "camera.X_WC: rotation has zero norm"}}) {
    const auto config = service::Config::load(test::in_sources("deploy/lab.toml"),
                                              {std::string("camera.X_WC=") + pose});
    ASSERT_TRUE(config) << config.error().message();
    const auto refused = Teller::create(*config, {});
    ASSERT_FALSE(refused) << pose;
    EXPECT_EQ(refused.error().message(), words);
    EXPECT_EQ(refused.error().exit, exit_wrong_use);
  }
}

}  // namespace
}  // namespace prehend::ros
