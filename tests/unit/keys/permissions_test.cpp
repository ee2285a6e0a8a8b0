// Permissions as text: every role's come back as they were written, and a text that says more than
// ours can is refused.
#include "common/dds/permissions.hpp"

#include <gtest/gtest.h>

namespace prehend::dds {
namespace {

Permissions of(Role role) {
  Permissions permissions = min_permissions(role);
  permissions.subject = "CN=somebody";
  permissions.from = "2026-11-20T12:00:00";
  permissions.until = "2027-11-20T12:00:00";
  return permissions;
}

TEST(Permissions, ComeBackAsTheyWereWritten) {
  for (const auto& [role, name] : role_names) {
    const Permissions written = of(role);
    const auto read = read_permissions(text(written));
    ASSERT_TRUE(read) << name << ": " << read.error().message();
    EXPECT_EQ(*read, written) << name;
  }
}

TEST(Permissions, HoldInOneRigAndDomain) {
  Permissions bound = of(Role::glove);
  bound.scope = *scope_of("left", 7);
  const std::string written = text(bound);
  EXPECT_EQ(written.find("<partition>*</partition>"), std::string::npos) << written;
  EXPECT_EQ(written.find("232"), std::string::npos) << written;
  const auto read = read_permissions(written);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(*read, bound);
  EXPECT_TRUE(read->scope.covers("left", 7));
  EXPECT_FALSE(read->scope.covers("left", 0));
  EXPECT_FALSE(read->scope.covers("right", 7));
  EXPECT_FALSE(read->scope.covers("*", 7));
  EXPECT_TRUE(Scope{}.covers("anything", 200));
}

// A pattern would stand for other rigs, and markup for other rules.
TEST(Permissions, ARigThatIsNoNameIsRefused) {
  for (const char* rig : {"", "*", "a*", "a?", "[ab]", "a b", "<x>", "a&b", "a\nb", "\x1b[2J"})
    EXPECT_FALSE(scope_of(rig, 0)) << rig;
  for (const char* rig : {"lab", "demo-17-a", "prüfstand"}) EXPECT_TRUE(scope_of(rig, 0)) << rig;
}

TEST(Permissions, ThatSayMoreAreRefused) {
  const std::string good = text(of(Role::mapping));
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string changed = good;
    changed.replace(changed.find(what), what.size(), instead);
    return changed;
  };
  for (const std::string& changed :
       {with("DENY", "ALLOW"), with("</allow_rule>", "</allow_rule><allow_rule/>"),
        with("</grant>", "</grant><grant name=\"x\"/>"), with("<max>232</max>", "<max>1</max>"),
        with("<partition>*</partition>", "<partition>a</partition>"),
        with("<permissions>", "<permissions><!-- -->"), good.substr(0, good.size() / 2),
        std::string(), std::string("<dds/>")})
    EXPECT_FALSE(read_permissions(changed)) << changed;
}

TEST(Permissions, AViewersTextPermitsNoWriting) {
  EXPECT_EQ(text(of(Role::viewer)).find("<publish>"), std::string::npos);
}

}  // namespace
}  // namespace prehend::dds
