// Who was let in, refused, or never answered, in the order in which either release of Fast DDS
// tells.
#include "common/dds/peers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/dds/guard/guarded_transport.hpp"
#include "common/dds/release/user_data.hpp"

namespace prehend::dds {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

// The other release of two.
const std::string other =
    own_middleware.starts_with("Fast DDS 2") ? "Fast DDS 3.1.2" : "Fast DDS 2.9.1";

Announcement announcement(std::uint8_t n, const std::string& name, const std::string& middleware,
                          const std::string& authority) {
  Announcement said;
  said.participant[11] = n;
  said.name = name;
  said.middleware = middleware;
  said.secured = !authority.empty();
  said.authority = authority;
  return said;
}

rtps::GUID_t guid(std::uint8_t n) {
  rtps::GUID_t made;
  made.guidPrefix.value[11] = n;
  made.entityId = rtps::c_EntityId_RTPSParticipant;
  return made;
}

const std::string own(own_middleware);

TEST(Peers, WhoIsLetInAfterItWasHeardOfIsDecided) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.hear(announcement(1, "mapping", own, "/CN=lab"));
  peers.on_judged(guid(1), true);
  peers.on_participant({News::found, guid(1), "mapping", own});
  EXPECT_FALSE(peers.wait_until_decided(guid(9)));
  EXPECT_THAT(peers.refused(), IsEmpty());
  EXPECT_THAT(peers.present(),
              ElementsAre(Pair(announcement(1, "", "", "").participant,
                               testing::Field(&Peers::Presented::name, "mapping"))));
}

// A stop of one rig waits for the robots of that rig alone.
TEST(Peers, TellsOfTheRoleAndTheRigsOfAPeer) {
  PacketGuard guard(false, false);
  Peers peers(nullptr, std::nullopt, guard);
  peers.on_participant({News::found, guid(1), "hand", own, Role::simulation});
  EXPECT_THAT(peers.present().begin()->second.rigs, IsEmpty());
  FoundEndpoint endpoint{News::found, true, guid(1)};
  endpoint.guid.entityId = 0x102;
  endpoint.rigs = {"left"};
  peers.on_endpoint(endpoint);
  endpoint.guid = guid(2);  // of nobody whom we know
  peers.on_endpoint(endpoint);
  const auto present = peers.present();
  ASSERT_EQ(present.size(), 1u);
  EXPECT_EQ(present.begin()->second.role, Role::simulation);
  EXPECT_THAT(present.begin()->second.rigs, ElementsAre("left"));
}

// Over TCP nobody is heard of before Fast DDS 3 tells.
TEST(Peers, WhoIsLetInBeforeItIsKnownIsDecided) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.on_judged(guid(1), true);
  peers.on_participant(
      {News::found, guid(1), "mapping", own, Role::mapping, true, "/CN=lab", "/CN=mapping"});
  EXPECT_FALSE(peers.wait_until_decided(guid(9)));
  EXPECT_THAT(peers.refused(), IsEmpty());
}

TEST(Peers, WhoDoesNotAnswerIsNamed) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.hear(announcement(1, "mapping", own, "/CN=lab"));
  const auto undecided = peers.wait_until_decided(guid(9));
  ASSERT_TRUE(undecided);
  EXPECT_EQ(undecided->name, "mapping");
}

TEST(Peers, OneIsNotAStrangerToItself) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.hear(announcement(1, "mapping", own, "/CN=lab"));
  EXPECT_FALSE(peers.wait_until_decided(guid(1)));
}

TEST(Peers, RefusalsSayWhy) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.hear(announcement(1, "mapping", own, "/CN=other"));
  peers.hear(announcement(2, "stranger", own, ""));
  peers.hear(announcement(3, "thief", own, "/CN=lab"));
  for (const std::uint8_t n : {1, 2, 3}) peers.on_judged(guid(n), false);
  EXPECT_THAT(peers.refused(), ElementsAre(Pair(HasSubstr("mapping, whose keys are of another"), 1),
                                           Pair(HasSubstr("stranger, which has no keys"), 1),
                                           Pair(HasSubstr("thief, whose keys are revoked"), 1)));
}

// Their handshake never ends: nobody waits for it, and what to do is said once.
TEST(Peers, SecuredPeersOfAnotherReleaseAreRefusedAtOnce) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.hear(announcement(1, "mapping", other, "/CN=lab"));
  peers.hear(announcement(1, "mapping", other, "/CN=lab"));
  EXPECT_FALSE(peers.wait_until_decided(guid(9)));
  peers.on_judged(guid(1), false);
  EXPECT_THAT(peers.refused(),
              ElementsAre(Pair("mapping, which has " + other +
                                   ", not " PREHEND_FAST_DDS_RELEASE
                                   ": a secured lab is all Debian 12 or all Debian 13",
                               1)));
}

TEST(Peers, WithoutKeysEveryReleaseIsWelcome) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, std::nullopt, guard);
  peers.hear(announcement(1, "mapping", other, ""));
  peers.hear(announcement(2, "secured", other, "/CN=lab"));
  EXPECT_THAT(
      peers.refused(),
      ElementsAre(Pair(HasSubstr("secured, which is secured while this process is not"), 1)));
  EXPECT_EQ(peers.present().size(), 2u);
}

// A plaintext farewell may be forged.
TEST(Peers, AFarewellThatIsOnlyHeardEndsNobodyWhoWasLetIn) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, "CN=lab", guard);
  peers.hear(announcement(1, "mapping", own, "/CN=lab"));
  peers.on_judged(guid(1), true);
  Announcement farewell = announcement(1, "", "", "");
  farewell.leaves = true;
  peers.hear(farewell);
  EXPECT_EQ(peers.present().size(), 1u);
  peers.on_participant({News::gone, guid(1)});
  EXPECT_THAT(peers.present(), IsEmpty());
}

TEST(Peers, RoleIsAnnouncedOrIsThatOfTheCertificate) {
  PacketGuard guard(false, true);
  Peers peers(nullptr, std::nullopt, guard);
  const auto role = [](Peers& of, std::uint8_t n) {
    return of.role_of(announcement(n, "", "", "").participant);
  };
  EXPECT_EQ(role(peers, 1), std::nullopt) << "nobody knows it";
  peers.on_participant({News::found, guid(1), "operator", own, Role::replayer});
  EXPECT_EQ(role(peers, 1), Role::replayer);
  peers.on_participant({News::found, guid(2), "operator", own, std::nullopt});
  EXPECT_EQ(role(peers, 2), std::nullopt) << "a name is no role";
  peers.on_participant({News::gone, guid(1)});
  EXPECT_EQ(role(peers, 1), std::nullopt);

  Peers secured(nullptr, "CN=lab", guard);
  // Of a release that tells at once, and of one that is heard of before.
  secured.on_participant(
      {News::found, guid(3), "a", own, Role::operator_, true, "/CN=lab", "/CN=replayer-2"});
  Announcement said = announcement(4, "b", own, "/CN=lab");
  said.role = Role::operator_;
  said.certificate = "/CN=laptop/OU=viewer";
  secured.hear(said);
  secured.on_judged(guid(4), true);
  secured.on_participant({News::found, guid(4), "b", own, Role::operator_});
  EXPECT_EQ(role(secured, 3), Role::replayer);
  EXPECT_EQ(role(secured, 4), Role::viewer);
  // Over TCP nobody hears of the certificate; who has none of this lab is not let in.
  secured.on_judged(guid(5), true);
  secured.on_participant({News::found, guid(5), "c", own, Role::console});
  EXPECT_EQ(role(secured, 5), Role::console);
}

TEST(RoleOfCertificate, IsItsUnitOrElseItsName) {
  EXPECT_EQ(role_of_certificate("/CN=glove"), Role::glove);
  EXPECT_EQ(role_of_certificate("CN=glove-left"), Role::glove);
  EXPECT_EQ(role_of_certificate("/CN=laptop/OU=operator"), Role::operator_);
  EXPECT_EQ(role_of_certificate("OU=viewer,CN=glove"), Role::viewer);
  for (const char* none :
       {"", "/", "glove", "/CN=", "/CN=gloves", "/CN=laptop", "/OU=x/CN=glove", "/XCN=glove"})
    EXPECT_EQ(role_of_certificate(none), std::nullopt) << none;
}

}  // namespace
}  // namespace prehend::dds
