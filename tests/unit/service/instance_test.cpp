// The key of a status says which of two gloves, mappings or robots it is of, and only there.
#include "common/service/instance.hpp"

#include <gtest/gtest.h>

#include "tests/support/paths/paths.hpp"

namespace prehend::service {
namespace {

TEST(Instance, IsThatOfTheConfiguration) {
  const auto config = Config::load(test::in_sources("deploy/lab.toml"),
                                   {"mapping.hand_name=left", "glove.name=blue"});
  ASSERT_TRUE(config);
  EXPECT_EQ(instance_of(*config, "mapping"), "left");
  EXPECT_EQ(instance_of(*config, "glove"), "blue");
  EXPECT_EQ(instance_of(*config, "simulation"), "") << "there is one for both hands";
}

TEST(Instance, IsReadFromTheKey) {
  for (const std::string instance : {"left", "", "a/b"})
    EXPECT_EQ(instance_in(status_key("mapping", "host.example", instance)), instance);
  EXPECT_EQ(instance_in(status_key("mapping", "host", std::string(200, 'x'))),
            std::string(32, 'x'));
  for (const std::string strange :
       {"", "mapping", "mapping@", "mapping@host", "mapping@host/1", "/@/"})
    EXPECT_EQ(instance_in(strange), "") << strange;
}

}  // namespace
}  // namespace prehend::service
