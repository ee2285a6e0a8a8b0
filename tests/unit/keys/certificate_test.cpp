// Certificates, revocation lists and signed texts: what one authority made holds before it, and
// nothing else does: neither what another made, nor what was altered, nor what its time has passed.
#include "common/keys/certificate.hpp"

#include <gtest/gtest.h>

namespace prehend::keys {
namespace {

using std::chrono::days;
using std::chrono::hours;

const Time now = from_ns(1'800'000'000'000'000'000);
const Validity long_time{now - days(1), now + days(3650)};

struct Lab {
  Identity authority = *make_authority("Prehend lab test", long_time);
  Identity glove = *issue(authority, "glove", {}, {now - days(1), now + days(30)});
  std::string nobody_gone = *revocation_list(authority, {}, long_time);
};

TEST(Certificate, TellsItsFacts) {
  const Lab lab;
  const auto known = facts(lab.glove.certificate);
  ASSERT_TRUE(known) << known.error().message();
  EXPECT_EQ(known->subject, "CN=glove");
  EXPECT_EQ(known->issuer, "CN=Prehend lab test");
  EXPECT_EQ(known->valid.from, now - days(1));
  EXPECT_EQ(known->valid.until, now + days(30));
  EXPECT_NE(known->serial,
            facts(issue(lab.authority, "glove", {}, long_time)->certificate)->serial);
}

TEST(Certificate, IsGoodBeforeItsAuthorityForItsTime) {
  const Lab lab, other;
  const auto good = [&](const Identity& identity, const std::string& authority,
                        const std::string& list,
                        Time when) { return check(identity, authority, list, when).has_value(); };
  const std::string& authority = lab.authority.certificate;
  EXPECT_TRUE(good(lab.glove, authority, lab.nobody_gone, now));
  EXPECT_FALSE(good(lab.glove, authority, lab.nobody_gone, now - days(2)));
  EXPECT_FALSE(good(lab.glove, authority, lab.nobody_gone, now + days(31)));
  EXPECT_FALSE(good(other.glove, authority, lab.nobody_gone, now));
  EXPECT_FALSE(good(lab.glove, other.authority.certificate, other.nobody_gone, now));
  EXPECT_FALSE(good(lab.glove, authority, other.nobody_gone, now));
  EXPECT_FALSE(good({lab.glove.certificate, other.glove.key}, authority, lab.nobody_gone, now));
  EXPECT_FALSE(good({lab.glove.certificate, ""}, authority, lab.nobody_gone, now));
  EXPECT_FALSE(good({"", lab.glove.key}, authority, lab.nobody_gone, now));
}

TEST(Certificate, IsGrantedToAKeyThatTheAuthorityNeverSees) {
  const Lab lab;
  const auto asked = request("glove-left");
  ASSERT_TRUE(asked) << asked.error().message();
  EXPECT_EQ(asked->text.find("PRIVATE"), std::string::npos);
  EXPECT_EQ(name_in(asked->text), "glove-left");
  const auto granted = grant(lab.authority, asked->text, {}, {now - days(1), now + days(30)});
  ASSERT_TRUE(granted) << granted.error().message();
  EXPECT_EQ(facts(*granted)->subject, "CN=glove-left");
  EXPECT_TRUE(check({*granted, asked->key}, lab.authority.certificate, lab.nobody_gone, now));
  EXPECT_FALSE(check({*granted, lab.glove.key}, lab.authority.certificate, lab.nobody_gone, now));
}

TEST(Certificate, IsNotGrantedToWhoDoesNotHoldTheKey) {
  const Lab lab;
  std::string asked = request("glove")->text;
  // Another name in the same request: its signature no longer holds.
  const std::size_t middle = asked.size() / 2;
  for (std::size_t i = middle; i < middle + 8; ++i) asked[i] = asked[i] == 'A' ? 'B' : 'A';
  EXPECT_FALSE(grant(lab.authority, asked, {}, long_time));
  EXPECT_FALSE(grant(lab.authority, "", {}, long_time));
  EXPECT_FALSE(grant(lab.authority, lab.glove.certificate, {}, long_time));
}

// As openssl req makes it with -subj /.
TEST(Certificate, ARequestHasAName) {
  const auto name = name_in(R"(-----BEGIN CERTIFICATE REQUEST-----
MIG7MGICAQAwADBZMBMGByqGSM49AgEGCCqGSM49AwEHA0IABMKmCjpQVKKmOuM2
l0zttXvu5EXMtFRkiOcuQt/XQz51PeZ8gcKGiAJxO0dak99cXU2o+NOB5jR0+H/f
XDIzla2gADAKBggqhkjOPQQDAgNJADBGAiEAlJFVv444WclsrKc5Ukxeg0AHDOsQ
LEvgRRmsPH5La30CIQC9ESd3hVSC5VPttFwHTZKIY8APHeT0ZXt9d/j1nvfZkg==
-----END CERTIFICATE REQUEST-----
)");
  ASSERT_FALSE(name);
  EXPECT_EQ(name.error().message(), "the request has no name (make it by prehend keys request)");
}

TEST(Certificate, AListTellsWhenItWasSigned) {
  const Lab lab;
  EXPECT_EQ(signed_at(lab.nobody_gone), now);
  EXPECT_FALSE(signed_at(""));
}

TEST(Certificate, RevokedIsNoLongerGood) {
  const Lab lab;
  const Identity mapping = *issue(lab.authority, "mapping", {}, long_time);
  const std::vector<Revoked> gone{{facts(lab.glove.certificate)->serial, now - hours(1)}};
  const auto list = revocation_list(lab.authority, gone, long_time);
  ASSERT_TRUE(list) << list.error().message();
  const auto read = revoked(*list, lab.authority.certificate);
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->front().serial, gone.front().serial);
  EXPECT_EQ(read->front().when, gone.front().when);
  const auto checked = check(lab.glove, lab.authority.certificate, *list, now);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().what.find("revoked"), std::string::npos) << checked.error().what;
  EXPECT_TRUE(check(mapping, lab.authority.certificate, *list, now));
  EXPECT_FALSE(revoked(*list, Lab().authority.certificate)) << "another authority's list";
}

TEST(Signature, HoldsForTheTextAndTheAuthorityAlone) {
  const Lab lab;
  const std::string text = "<a>\n  <topic>glove/frame</topic>\n</a>\n";
  const auto signed_text = sign(lab.authority, text);
  ASSERT_TRUE(signed_text) << signed_text.error().message();
  const auto read = verified(*signed_text, lab.authority.certificate);
  ASSERT_TRUE(read) << read.error().message();
  std::string plain = *read;
  std::erase(plain, '\r');
  EXPECT_EQ(plain, text);
  std::string altered = *signed_text;
  altered[altered.find("glove/frame")] = 'G';
  EXPECT_FALSE(verified(altered, lab.authority.certificate));
  EXPECT_FALSE(verified(*signed_text, Lab().authority.certificate));
  // Whom the authority vouches for is not the authority.
  EXPECT_FALSE(verified(*sign(lab.glove, text), lab.authority.certificate));
  for (const char* rubbish : {"", "text", "-----BEGIN CERTIFICATE-----\n"})
    EXPECT_FALSE(verified(rubbish, lab.authority.certificate));
}

}  // namespace
}  // namespace prehend::keys
