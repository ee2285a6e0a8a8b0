// Keys that are whole, with rules for the lab that Fast DDS does not understand.
#include <gtest/gtest.h>

#include "common/dds/participant.hpp"
#include "common/dds/permissions.hpp"
#include "common/dds/security.hpp"
#include "common/keys/certificate.hpp"
#include "tests/support/domains/domain_lease.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::dds {
namespace {

TEST(SecuredLab, IsNotJoinedByRulesThatAreNone) {
  const Time today = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  const keys::Validity valid{today - std::chrono::days(1), today + std::chrono::days(9)};
  const auto authority = *keys::make_authority("lab", valid);
  const auto glove = *keys::issue(authority, "glove", {}, valid);
  Permissions permissions = min_permissions(Role::glove);
  permissions.subject = "CN=glove";
  permissions.from = "2020-01-01T00:00:00";
  permissions.until = "2120-01-01T00:00:00";
  const testing::Scratch folder;
  const auto put = [&](const char* name, const std::string& text) {
    testing::write_bytes(folder / name, text);
    std::filesystem::permissions(folder / name, std::filesystem::perms::owner_read);
  };
  put(key_files::authority, authority.certificate);
  put(key_files::certificate, glove.certificate);
  put(key_files::key, glove.key);
  put(key_files::revoked, *keys::revocation_list(authority, {}, valid));
  put(key_files::permissions, *keys::sign(authority, text(permissions)));
  put(key_files::governance, *keys::sign(authority, "<dds>let us in</dds>\n"));
  const test::DomainLease lease;
  const auto joined =
      Participant::create({.name = "glove",
                           .domain = lease.domain(),
                           .rig = "lab",
                           .network = {.keys = (folder / "authority.pem").parent_path()}});
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().what, "cannot join the secured lab");
}

}  // namespace
}  // namespace prehend::dds
