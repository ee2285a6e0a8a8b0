// `prehend keys`: for which rig a key is made is said, columns stay apart, and refusals name the
// key.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "common/keys/certificate.hpp"
#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

using ::testing::HasSubstr;

class Keys : public test::CommandTest {
 protected:
  Keys() : CommandTest(test::in_programs("prehend") + " keys") {}
};

// Guards a store for any rig, in which a key for the rig of lab.toml was made, unsaid.
TEST_F(Keys, AddSaysForWhichRig) {
  ASSERT_EQ(run("init " + in("keys") + " --rig any").code, 0);
  const auto lab = run("add viewer-anna --store " + in("keys"));
  EXPECT_EQ(lab.code, 0) << lab.complaint;
  EXPECT_THAT(lab.complaint, HasSubstr("made viewer-anna for rig lab"));
  EXPECT_THAT(lab.complaint, HasSubstr("--rig chooses another"));
  const auto any = run("add viewer-berta --rig any --store " + in("keys"));
  EXPECT_THAT(any.complaint, HasSubstr("made viewer-berta for any rig"));
}

TEST_F(Keys, ShowKeepsItsColumnsApart) {
  ASSERT_EQ(run("init " + in("keys") + " --rig a-rig-with-a-long-name").code, 0);
  ASSERT_EQ(run("add viewer-a-long-name-too --rig another --store " + in("keys")).code, 0);
  const auto shown = run("show --store " + in("keys"));
  EXPECT_EQ(shown.code, 0) << shown.complaint;
  const std::regex row(
      "viewer-a-long-name-too +viewer +valid +[0-9-]{10} +rig another.* writes .*");
  EXPECT_TRUE(std::regex_search(shown.output, row)) << shown.output;
}

// Each refusal says what is wrong with which key.
TEST_F(Keys, RefusalsNameTheKey) {
  ASSERT_EQ(run("init " + in("keys") + " --rig any").code, 0);
  const std::string store = " --store " + in("keys");
  for (const char* made : {"add viewer-anna --rig any", "add viewer-old --rig any",
                           "add viewer-bad --rig any", "revoke viewer-old"})
    ASSERT_EQ(run(made + store).code, 0) << made;
  file("keys/viewer-bad/permissions.p7s", "spoilt");
  const std::string nameless = run("request anna --store " + in("there")).output;
  const std::string shouted = keys::request("Anna Smith").value().text;
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"init " + in("keys") + " --rig any", "keys: is there already (name a new folder)"},
           {"show --store " + in("nowhere"), "nowhere: is no keystore (`prehend keys init DIR`"},
           {"add anna --rig any" + store, "anna: has no role in its name (name the key ROLE"},
           {"add viewer-Anna --rig any" + store, "viewer-Anna: is no name for a key (small"},
           {"add viewer-anna --rig any" + store,
            "viewer-anna: there is a key of this name (--renew"},
           {"renew viewer-bad" + store,
            "viewer-bad: has the permissions of no role any more (keys"},
           {"revoke ../keys" + store, "../keys: is no name for a key (`prehend keys show` lists"},
           {"revoke viewer-berta" + store, "viewer-berta: there is no key of this name"},
           {"revoke viewer-old" + store, "viewer-old: is revoked already"},
           {"request Anna" + store, "Anna: is no name for a key (small letters"},
           {"request viewer-a --store " + file("no-folder", ""),
            "next-key.pem: cannot be written: Not a directory"},
           {"sign --rig any " + file("nameless", nameless) + store,
            "anna: has no role in its name (give"},
           {"sign --rig any " + file("shouted", shouted) + store,
            "Anna Smith: asks for a name that is none for a key (small letters"},
           {"install " + file("granted", "{}") + store,
            "granted: is not what `prehend keys sign` writes"}}) {
    const auto answer = run(arguments);
    EXPECT_NE(answer.code, 0) << arguments;
    EXPECT_THAT(answer.complaint, HasSubstr(says)) << arguments;
  }
}

}  // namespace
}  // namespace prehend
