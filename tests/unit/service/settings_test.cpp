// What a process was given is told on service/settings, whole or not at all.
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/service/shell.hpp"
#include "tests/support/domains/domain_lease.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::service {
namespace {

TEST(Settings, AreToldOnceAndNeverInPart) {
  const test::DomainLease lease;
  const std::string rig = "settings-" + std::to_string(getpid()), fits(512, 'a');
  auto shell = Shell::create(
      {"--config", test::in_sources("deploy/lab.toml"), "--set", "lab.rig=" + rig, "--set",
       "lab.domain=" + std::to_string(lease.domain()), "--set", "glove.user=" + fits, "--set",
       "mapping.glove=" + fits + "b", "--set", "keys.revocation_max_age=1"},
      {"talking", "of a test"});
  ASSERT_TRUE(shell) << shell.error().message();
  auto participant = dds::Participant::create(
      {.name = "test", .domain = lease.domain(), .rig = rig, .role = "viewer"});
  ASSERT_TRUE(participant) << participant.error().message();
  auto reader = participant->reader(dds::service_settings);
  ASSERT_TRUE(reader);
  ASSERT_TRUE(reader->raw().wait_for_unread_message({10, 0}));
  const auto told = reader->take();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].data.name().to_string(), "talking");
  ASSERT_EQ(told[0].data.settings().size(), 1U);
  EXPECT_EQ(told[0].data.settings()[0].key().to_string(), "glove.user");
  EXPECT_EQ(told[0].data.settings()[0].value().to_string(), fits);
}

}  // namespace
}  // namespace prehend::service
