// Profiles of the network: each is what its name says, wrong settings are errors with a mend, and
// nothing in the environment or the working directory changes DDS. That broken files stop a process
// is tests/integration/profiles_test.cpp, in processes of their own: Fast DDS keeps what it has
// read.
#include "common/dds/network.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>

#include "common/dds/participant.hpp"
#include "common/dds/server_watch.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend::dds {
namespace {

using eprosima::fastdds::rtps::UDPv4TransportDescriptor;

TEST(Network, TheLaptopIsConfinedToLoopback) {
  const auto qos = participant_qos({});
  ASSERT_TRUE(qos) << qos.error().message();
  EXPECT_FALSE(qos->transport().use_builtin_transports);
  ASSERT_EQ(qos->transport().user_transports.size(), 1u);
  const auto* udp =
      dynamic_cast<UDPv4TransportDescriptor*>(qos->transport().user_transports[0].get());
  ASSERT_TRUE(udp);
  EXPECT_EQ(udp->interfaceWhiteList, std::vector<std::string>{"127.0.0.1"});
}

TEST(Network, TheLanUsesEveryInterfaceByUdpAlone) {
  const auto qos = participant_qos({.profile = "lan"});
  ASSERT_TRUE(qos) << qos.error().message();
  EXPECT_FALSE(qos->transport().use_builtin_transports);
  ASSERT_EQ(qos->transport().user_transports.size(), 1u);
  const auto* udp =
      dynamic_cast<UDPv4TransportDescriptor*>(qos->transport().user_transports[0].get());
  ASSERT_TRUE(udp);
  EXPECT_TRUE(udp->interfaceWhiteList.empty());
}

TEST(Network, ClientsOfAServerKnowItByItsPort) {
  const Network network{.profile = "server", .servers = {"127.0.0.1", "127.0.0.1:11812"}};
  const auto client = participant_qos(network);
  ASSERT_TRUE(client) << client.error().message();
  const auto& discovery = client->wire_protocol().builtin.discovery_config;
  EXPECT_EQ(discovery.discoveryProtocol, DiscoveryProtocol::CLIENT);
  ASSERT_EQ(discovery.m_DiscoveryServers.size(), 2u);
  const auto all = participant_qos(network, {.sees_all = true});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->wire_protocol().builtin.discovery_config.discoveryProtocol,
            DiscoveryProtocol::SUPER_CLIENT);
  for (int i = 0; i < 2; ++i) {
    const auto server = participant_qos({.profile = "server"},
                                        {.serves = "127.0.0.1:" + std::to_string(11811 + i)});
    ASSERT_TRUE(server) << server.error().message();
    const auto known = std::next(discovery.m_DiscoveryServers.begin(), i);
#if PREHEND_FAST_DDS == 2
    EXPECT_EQ(server->wire_protocol().prefix, known->guidPrefix);
#else  // a server is its address, which says the port
    EXPECT_EQ(server->wire_protocol().prefix,
              server_prefix(static_cast<std::uint16_t>(known->port)));
#endif
  }
}

// Both found the same port free before either listened there, and one of them was never heard.
TEST(Network, WhoJoinsAtOnceListensAtAPortOfItsOwn) {
  const auto port_of = [](const auto& qos) {
    for (const auto& own : qos.wire_protocol().builtin.metatrafficUnicastLocatorList)
      if (own.kind == LOCATOR_KIND_TCPv4) return rtps::IPLocator::getPhysicalPort(own);
    return std::uint16_t{0};
  };
  const auto one = participant_qos({.profile = "wan", .insecure = true});
  ASSERT_TRUE(one) << one.error().message();
  EXPECT_NE(port_of(*one), 0);
  const std::string same = "127.0.0.1:" + std::to_string(port_of(*one));
  EXPECT_FALSE(participant_qos({.profile = "wan", .listen = same, .insecure = true}));
  std::uint16_t other = 0;
  {
    const auto two = participant_qos({.profile = "wan", .insecure = true});
    ASSERT_TRUE(two) << two.error().message();
    other = port_of(*two);
    EXPECT_NE(other, port_of(*one));
  }
  const auto three = participant_qos({.profile = "wan", .insecure = true});
  ASSERT_TRUE(three) << three.error().message();
  EXPECT_EQ(port_of(*three), other) << "its owner has gone";
}

// It listens on every interface: forgotten keys must not open the lab to whoever reaches it.
TEST(Network, SitesWithoutKeysMustBeAskedFor) {
  const auto open = participant_qos({.profile = "wan"});
  ASSERT_FALSE(open);
  EXPECT_NE(open.error().hint.find("lab.insecure"), std::string::npos);
  EXPECT_TRUE(participant_qos({.profile = "wan", .insecure = true}));
}

TEST(Network, WrongSettingsAreErrorsWithAMend) {
  for (const Network& network :
       {Network{.profile = "house"}, Network{.profile = "server"},
        Network{.profile = "server", .servers = {"127.0.0.1:0"}},
        Network{.profile = "server", .servers = {"127.0.0.1:port"}},
        Network{.profile = "server", .servers = {"127.0.0.1:70000"}},
        Network{.profile = "server", .servers = {":11811"}},
        Network{.profile = "server", .servers = {"no.such.host.invalid:11811"}},
        Network{.profile = "wan", .listen = "127.0.0.1", .insecure = true},
        Network{.profile = "wan", .peers = {"127.0.0.1:port"}, .insecure = true},
        Network{.profile = "wan",
        .peers = {"127.0.0.1"},
        .listen = "127.0.0.1:29420",
        .insecure = true}}) {
    const auto qos = participant_qos(network);
    ASSERT_FALSE(qos) << network.profile;
    EXPECT_FALSE(qos.error().what.empty());
    EXPECT_FALSE(qos.error().where.empty());
  }
  EXPECT_FALSE(participant_qos({.profile = "server", .servers = {"127.0.0.1:11811"}},
                               {.serves = "127.0.0.1:11811"}))
      << "a server linked with itself";
}

TEST(Network, AProfileThatIsNotInstalledIsNamed) {
  ::setenv("PREHEND_SHARE", "/nowhere", 1);
  const auto qos = participant_qos({.profile = "lan"});
  ::unsetenv("PREHEND_SHARE");
  ASSERT_FALSE(qos);
  EXPECT_EQ(qos.error().what, "there is no such profile");
  EXPECT_EQ(qos.error().where, "/nowhere/dds/lan.xml");
}

// In a process of its own: Fast DDS keeps a profile by its name.
TEST(NetworkDeathTest, SitesNeedTcp) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto share = std::filesystem::path(::testing::TempDir()) /
                     ("prehend-share-" + std::to_string(std::random_device{}()));
  const auto ask = [&] {
    std::filesystem::create_directories(share / "dds");
    const auto udp = [](const std::string& name) {
      return "<transport_descriptor><transport_id>" + name +
             "</transport_id><type>UDPv4</type></transport_descriptor>";
    };
    std::ofstream(share / "dds" / "wan.xml")
        << R"(<?xml version="1.0"?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
<transport_descriptors>)" +
               udp("a") + udp("b") +
               R"(</transport_descriptors><participant profile_name="wan"><rtps><builtin>
<discovery_config><discoveryProtocol>SIMPLE</discoveryProtocol></discovery_config></builtin>
<userTransports><transport_id>a</transport_id><transport_id>b</transport_id></userTransports>
<useBuiltinTransports>false</useBuiltinTransports></rtps></participant></profiles></dds>)";
    ::setenv("PREHEND_SHARE", share.c_str(), 1);
    const auto qos = participant_qos({.profile = "wan", .insecure = true});
    std::filesystem::remove_all(share);
    std::cerr << (qos ? "usable" : qos.error().message()) << std::endl;
    std::exit(0);
  };
  EXPECT_EXIT(ask(), ::testing::ExitedWithCode(0), "profile wan: has no TCPv4 transport");
}

TEST(Network, DiscoveryServersDoWithoutKeys) {
  const auto qos =
      participant_qos({.profile = "server", .servers = {"127.0.0.1"}, .keys = "/nowhere"});
  ASSERT_FALSE(qos);
  EXPECT_EQ(qos.error().what, "discovery servers of Fast DDS 2.9 cannot be secured");
}

// A profile that turns everything best effort and confines it to an address that is not ours, and a
// discovery server that is not there: whoever obeyed one of them would hear nothing.
TEST(Network, EnvironmentAndWorkingDirectoryHaveNoEffect) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("prehend-network-" + std::to_string(std::random_device{}()));
  std::filesystem::create_directories(folder);
  const std::string profile = R"(<?xml version="1.0"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
<transport_descriptors><transport_descriptor><transport_id>nowhere</transport_id><type>UDPv4</type>
<interfaceWhiteList><address>192.0.2.1</address></interfaceWhiteList></transport_descriptor>
</transport_descriptors><participant profile_name="deaf" is_default_profile="true"><rtps>
<userTransports><transport_id>nowhere</transport_id></userTransports>
<useBuiltinTransports>false</useBuiltinTransports></rtps></participant></profiles>)";
  const auto outside = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  std::ofstream(profiles_file) << profile;
  std::ofstream("named.xml") << profile;
  ::setenv(profiles_variable, (folder / "named.xml").c_str(), 1);
  ::setenv("ROS_DISCOVERY_SERVER", "192.0.2.1:11811", 1);
  const auto influences = environment_overrides();
  EXPECT_EQ(influences.size(), 3u);
  for (const Error& influence : influences) EXPECT_FALSE(influence.hint.empty());

  const test::DomainLease lease;
  const int domain = lease.domain();
  const std::string rig = "rig" + std::to_string(std::random_device{}());
  auto here = Participant::create({.name = "here", .domain = domain, .rig = rig});
  auto there = Participant::create({.name = "there", .domain = domain, .rig = rig});
  std::filesystem::current_path(outside);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(here && there);
  auto writer = *here->writer(service_status);
  auto reader = *there->reader(service_status);
  ASSERT_TRUE(writer.write(v1::ServiceStatus{}));
  EXPECT_TRUE(reader.raw().wait_for_unread_message({10, 0}));
}

}  // namespace
}  // namespace prehend::dds
