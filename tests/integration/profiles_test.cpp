// The networks of lab.network between real processes: each carries what it says and no more, and a
// profile that Fast DDS would pass over with a line in a log stops the process instead. What needs
// interfaces of its own runs in a network namespace, which takes root; it is skipped without.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <regex>
#include <sstream>

#include "common/base/paths.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

class Profiles : public Rig {
 protected:
  /// Runs a shell script where there is no interface but those that it makes.
  Answer alone(const std::string& script, double limit_s) {
    const std::string file = (folder_ / "script").string();
    std::ofstream(file) << "set -eu\nbin=" << test::in_programs("") << "\nlab='"
                        << joined(lab_arguments()) << "'\n"
                        << script;
    stage::Process::Options options;
    options.command = {"unshare", "-n", "-m", "sh", file};
    options.log = folder_ / "script.log";
    options.output = folder_ / "script.out";
    auto process = stage::Process::start(options);
    if (!process) throw std::runtime_error(process.error().message());
    const auto exit = process->wait(seconds(limit_s));
    process->stop(seconds(5));
    return {exit ? exit->code : -1, text(options.output), text(options.log)};
  }
  static bool may_make_namespaces() {
    return std::system("unshare -n -m ip link set lo up >/dev/null 2>&1") == 0;
  }
  static std::string joined(const Strings& words) {
    std::string all;
    for (const std::string& word : words) (all += word) += " ";
    return all;
  }
  static std::string text(const std::filesystem::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /// Is a service seen from where these settings join?
  bool sees(const std::string& service, const Strings& sets, const std::string& timeout = "15") {
    Strings arguments{"status", "--wait", service, "--timeout", timeout};
    const Strings lab = lab_arguments(sets);
    arguments.insert(arguments.end(), lab.begin(), lab.end());
    return run("prehend", arguments, 30).exit_code == 0;
  }
};

/// Every element of an XML text under another name, one at a time.
std::vector<std::pair<std::string, std::string>> misspelt(const std::string& xml) {
  std::vector<std::pair<std::string, std::string>> texts;
  const std::regex element("<([A-Za-z_]+)[ >]");
  for (std::sregex_iterator one(xml.begin(), xml.end(), element), end; one != end; ++one) {
    const std::string name = one->str(1);
    const auto begin = static_cast<std::size_t>(one->position());
    // Elements of one name are not nested here.
    const std::size_t close = xml.find(fmt::format("</{}>", name), begin);
    if (close == std::string::npos) continue;
    const std::size_t opened = begin + 1 + name.size(), closed = close + 2 + name.size();
    const std::string text = fmt::format("{}x{}x{}", xml.substr(0, opened),
                                         xml.substr(opened, closed - opened), xml.substr(closed));
    texts.emplace_back(name, text);
  }
  return texts;
}

TEST_F(Profiles, APartThatFastDdsWouldIgnoreStopsTheProcess) {
  const auto run_with = [&](const std::string& profile, const std::string& xml) {
    const auto share = folder_ / profile;
    std::filesystem::create_directories(share / "dds");
    const auto file = share / "dds" / fmt::format("{}.xml", profile);
    std::ofstream(file) << xml;
    stage::Process::Options options;
    options.command = {program("prehend"), "status",
                       "--timeout",        "0.1",
                       "--config",         test::in_sources("deploy/lab.toml")};
    const Strings lab = lab_arguments({fmt::format("lab.network={}", profile),
                                       "lab.server=[\"127.0.0.1\"]", "lab.insecure=true"});
    options.command.insert(options.command.end(), lab.begin(), lab.end());
    options.log = folder_ / fmt::format("{}.log", profile);
    options.environment = {{"PREHEND_SHARE", share.string()}};
    auto process = stage::Process::start(options);
    if (!process) throw std::runtime_error(process.error().message());
    const auto exit = process->wait(seconds(20));
    return Answer{exit ? exit->code : -1, "", text(options.log)};
  };
  const auto try_all = [&](const std::string& profile) {
    const std::string xml = text(test::in_sources("deploy/dds/" + profile + ".xml"));
    ASSERT_EQ(run_with(profile, xml).exit_code, 1) << profile;  // fine: nobody is there
    auto broken = misspelt(xml);
    ASSERT_GT(broken.size(), 10u);
    broken.emplace_back("half of the file", xml.substr(0, xml.size() / 2));
    broken.emplace_back("nothing", "");
    broken.emplace_back(
        "another name",
        std::regex_replace(xml, std::regex("profile_name=\"[a-z]+\""), "profile_name=\"other\""));
    broken.emplace_back("shared memory", std::regex_replace(xml, std::regex("UDPv4"), "SHM"));
    broken.emplace_back(
        "builtin transports",
        std::regex_replace(xml, std::regex("(<useBuiltinTransports>)false"), "$1true"));
    if (profile == "laptop")
      broken.emplace_back("another address",
                          std::regex_replace(xml, std::regex("127\\.0\\.0\\.1"), "192.0.2.1"));
    for (const auto& [what, changed] : broken) {
      const Answer answer = run_with(profile, changed);
      EXPECT_EQ(answer.exit_code, 3) << profile << ", " << what << ": " << answer.log;
      EXPECT_NE(answer.log.find(profile), std::string::npos) << answer.log;
    }
  };
  {
    std::vector<std::jthread> at_once;
    for (const char* profile : {"laptop", "lan", "server", "wan"})
      at_once.emplace_back(try_all, profile);
  }
  EXPECT_EQ(run("prehend", {"status", "--set", "lab.network=house"}, 10).exit_code, 3);
}

TEST_F(Profiles, TheLaptopNeedsOnlyLoopbackAndNothingLeavesIt) {
  if (!may_make_namespaces()) GTEST_SKIP() << "a network namespace needs root";
  const Answer answer = alone(R"sh(
$bin/prehend status $lab && exit 10 || [ $? -eq 3 ] || exit 11
unshare -n sleep 300 & far=$!
trap 'kill $far' EXIT
until [ "$(readlink /proc/$far/ns/net)" != "$(readlink /proc/$$/ns/net)" ]; do sleep 0.05; done
there="nsenter -t $far -n"
ip link set lo up; $there ip link set lo up
ip link add outside type veth peer name cable
ip link set outside addrgenmode none; ip link set cable addrgenmode none
ip link set cable netns $far
ip addr add 10.9.0.1/24 dev outside; ip link set outside up
$there ip addr add 10.9.0.2/24 dev cable; $there ip link set cable up
ip route add default via 10.9.0.2
sent() { ip -j -s link show outside | grep -o '"tx":{"bytes":[0-9]*'; }
before=$(sent)
$bin/prehend-simulation $lab & simulation=$!
$bin/prehend status --wait simulation --timeout 15 $lab || exit 12
[ "$(sent)" = "$before" ] || exit 13
# Who listens on the network hears nothing of it.
sees() { $there $bin/prehend status --wait simulation --timeout $1 $lab --set lab.network=lan; }
sees 2 && exit 14
kill $simulation; wait $simulation
$bin/prehend-simulation $lab --set lab.network=lan & simulation=$!
sees 15 || exit 15
[ "$(sent)" != "$before" ] || exit 16
kill $simulation; wait $simulation
)sh",
                              60);
  EXPECT_EQ(answer.exit_code, 0) << answer.log;
  EXPECT_NE(answer.log.find("loopback interface is down"), std::string::npos) << answer.log;
}

// Two sites with a cable between them that carries TCP alone; with keys, TLS.
TEST_F(Profiles, SitesReachEachOtherByTcpAndWithKeysByTlsAlone) {
  if (!may_make_namespaces()) GTEST_SKIP() << "a network namespace needs root";
  const Answer answer = alone(R"sh(
unshare -n sleep 300 & far=$!
until [ "$(readlink /proc/$far/ns/net)" != "$(readlink /proc/$$/ns/net)" ]; do sleep 0.05; done
there="nsenter -t $far -n"
ip link set lo up; ip link add here type veth peer name there; ip link set there netns $far
ip addr add 10.9.0.1/24 dev here; ip link set here up
$there ip link set lo up; $there ip addr add 10.9.0.2/24 dev there; $there ip link set there up
iptables -A INPUT -i here -p udp -j DROP && $there iptables -A INPUT -i there -p udp -j DROP ||
  exit 77
keys=$(mktemp -d)/keys other=$(mktemp -d)/keys
simulation=
trap 'kill $far $simulation || true; rm -r ${keys%/keys} ${other%/keys}' EXIT
$bin/prehend keys init $keys $lab; $bin/prehend keys init $other $lab
wan="$lab --set lab.network=wan --set lab.insecure=true"
sees() { $there $bin/prehend status --wait simulation $wan --set 'lab.peers=["10.9.0.1"]' "$@"; }
$bin/prehend-simulation $wan & simulation=$!
sees --timeout 30 || exit 10
kill $simulation; wait $simulation || exit 11
$bin/prehend-simulation $wan --set lab.keys=$keys & simulation=$!
sees --timeout 30 --set lab.keys=$keys || exit 12
sees --timeout 4 && exit 13
sees --timeout 4 --set lab.keys=$other && exit 14
sees --timeout 30 --set lab.keys=$keys || exit 15
)sh",
                              150);
  if (answer.exit_code == 77) GTEST_SKIP() << "iptables is needed to stop UDP";
  EXPECT_EQ(answer.exit_code, 0) << answer.log;
}

// Of a hundred who call and say nothing, and of a hundred who begin a greeting and do not end it,
// nobody keeps out a site with keys. With one of them nobody else came in for as long as it stayed.
TEST_F(Profiles, ThoseWhoCallAndSayNothingKeepNoSiteOut) {
  if (!may_make_namespaces()) GTEST_SKIP() << "a network namespace needs root";
  const Answer answer = alone(R"sh(
unshare -n sleep 300 & far=$!
until [ "$(readlink /proc/$far/ns/net)" != "$(readlink /proc/$$/ns/net)" ]; do sleep 0.05; done
there="nsenter -t $far -n"
ip link set lo up; ip link add here type veth peer name there; ip link set there netns $far
ip addr add 10.9.0.1/24 dev here; ip link set here up
$there ip link set lo up; $there ip addr add 10.9.0.2/24 dev there; $there ip link set there up
iptables -A INPUT -i here -p udp -j DROP && $there iptables -A INPUT -i there -p udp -j DROP ||
  exit 77
keys=$(mktemp -d)/keys
simulation= callers=
trap 'kill $far $simulation $callers || true; rm -r ${keys%/keys}' EXIT
$bin/prehend keys init $keys $lab
wan="$lab --set lab.network=wan --set lab.keys=$keys"
$bin/prehend-simulation $wan & simulation=$!
sees() { $there $bin/prehend status --wait simulation $wan --set 'lab.peers=["10.9.0.1:7420"]' "$@"; }
took() { begin=$(date +%s%N); "$@" || return 1; echo "took $((($(date +%s%N) - begin) / 1000000)) ms" >&2; }
for visit in 1 2 3; do took sees --timeout 30 || exit 10; done
# Silent, and with the head of a ClientHello that never ends; they call again when they are cut.
calls='while :; do
  held=
  for n in $(seq 50); do
    exec {fd}<>/dev/tcp/10.9.0.1/7420 || continue
    held="$held $fd"
    [ -z "$1" ] || printf "\x16\x03\x01\x01\x00\x01" >&$fd
  done
  sleep 3
  for fd in $held; do exec {fd}>&-; done
done'
for one in "" "" greets greets; do
  $there bash -c "$calls" calls "$one" 2>/dev/null & callers="$callers $!"
done
sleep 1
for visit in 1 2 3; do took sees --timeout 30 || exit 11; done
kill -0 $simulation
)sh",
                              250);
  if (answer.exit_code == 77) GTEST_SKIP() << "iptables is needed to stop UDP";
  EXPECT_EQ(answer.exit_code, 0) << answer.log;
  std::vector<int> took;
  std::istringstream log(answer.log);
  for (std::string line; std::getline(log, line);)
    if (int ms = 0; std::sscanf(line.c_str(), "took %d ms", &ms) == 1) took.push_back(ms);
  ASSERT_EQ(took.size(), 6u) << answer.log;
  // Medians: on a busy machine one visit may lose a packet of discovery, with callers or without.
  std::sort(took.begin(), took.begin() + 3);
  std::sort(took.begin() + 3, took.end());
  std::cout << "joined and seen after " << took[1] << " ms, among silent ones after " << took[4]
            << " ms, at most " << took[5] << " ms\n";
  EXPECT_LT(took[4], took[1] + 2000);
}

// Two sites whose networks have the same addresses, as two container engines give them, each behind
// a router that translates them: they meet only at the two ports that the robot's router forwards.
TEST_F(Profiles, SitesBehindRoutersMeetAtForwardedPortsAlone) {
  if (!may_make_namespaces()) GTEST_SKIP() << "a network namespace needs root";
  const Answer answer = alone(R"sh(
spaces= services=
trap 'kill $services $spaces; rm -r ${keys%/keys}' EXIT
space() {
  unshare -n sleep 300 & spaces="$spaces $!"
  until [ "$(readlink /proc/$!/ns/net)" != "$(readlink /proc/$$/ns/net)" ]; do sleep 0.05; done
  eval "$1=$! in_$1='nsenter -t $! -n'"
}
for one in robot robot_router glove_router glove; do space $one; eval "\$in_$one ip link set lo up"; done
wire() {  # SPACE ADDRESS SPACE ADDRESS
  eval "one=\$$1 other=\$$3"
  ip link add to_$3 netns $one type veth peer name to_$1 netns $other
  nsenter -t $one -n ip addr add $2/24 dev to_$3; nsenter -t $one -n ip link set to_$3 up
  nsenter -t $other -n ip addr add $4/24 dev to_$1; nsenter -t $other -n ip link set to_$1 up
}
wire robot 192.168.7.2 robot_router 192.168.7.1
wire robot_router 198.51.100.1 glove_router 198.51.100.2
wire glove 192.168.7.2 glove_router 192.168.7.1
$in_robot ip route add default via 192.168.7.1; $in_glove ip route add default via 192.168.7.1
for one in robot glove; do
  eval "there=\$in_${one}_router"
  $there sh -c 'echo 1 >/proc/sys/net/ipv4/ip_forward' && $there iptables -P FORWARD DROP || exit 77
  $there iptables -A FORWARD -m state --state ESTABLISHED,RELATED -j ACCEPT
done
$in_glove_router iptables -A FORWARD -i to_glove -j ACCEPT
$in_glove_router iptables -t nat -A POSTROUTING -o to_robot_router -j MASQUERADE
$in_robot_router iptables -A FORWARD -o to_robot -p tcp --dport 7420:7421 -j ACCEPT
$in_robot_router iptables -t nat -A PREROUTING -i to_glove_router -p tcp --dport 7420:7421 \
  -j DNAT --to-destination 192.168.7.2

keys=$(mktemp -d)/keys
$bin/prehend keys init $keys $lab
wan="$lab --set lab.network=wan --set lab.keys=$keys"
start() { "$@" & services="$services $!"; }
start $in_robot $bin/prehend-mapping $wan --set lab.listen=198.51.100.1:7420
start $in_robot $bin/prehend-simulation $wan --set lab.listen=198.51.100.1:7421
dial="--set lab.peers=[\"198.51.100.1:7420\",\"198.51.100.1:7421\"]"
$in_glove $bin/prehend status --wait mapping --wait simulation --timeout 30 $wan $dial || exit 10
moved() {  # the hand follows the glove within $1 s
  end=$(($(date +%s) + $1))
  until $in_robot $bin/prehend status --json $wan | grep -q '"commands":{"per_second":[1-9]'; do
    [ $(date +%s) -lt $end ] || return 1
  done
}
$in_glove $bin/prehend-glove $wan $dial & glove=$!
moved 30 || exit 11
kill -9 $glove; wait $glove || true
$in_glove $bin/prehend-glove $wan $dial & glove=$!
services="$services $glove"
sleep 4  # until nothing of the first can be left in the rate
moved 20 || exit 12
# A port that is taken, and one that both listens and dials, are errors.
$in_robot $bin/prehend status $wan --set lab.listen=198.51.100.1:7420 && exit 13 || [ $? -eq 3 ] || exit 14
$in_glove $bin/prehend status $wan $dial --set lab.listen=198.51.100.1:7422 && exit 15 || [ $? -eq 3 ] || exit 16
)sh",
                              150);
  if (answer.exit_code == 77) GTEST_SKIP() << "iptables and forwarding are needed";
  EXPECT_EQ(answer.exit_code, 0) << answer.log;
}

// Over loopback addresses, so that it needs no network; multicast is not used by this profile.
TEST_F(Profiles, ADiscoveryServerBringsThemTogetherAndLinkedServersTheirClients) {
  const auto serve = [&](int n, Strings more) {
    Strings arguments{"discovery-server", "--listen", address(n)};
    const Strings lab = lab_arguments();
    arguments.insert(arguments.end(), lab.begin(), lab.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start_program("prehend", arguments);
  };
  const auto client = [&](int n) {
    return Strings{"lab.network=server", fmt::format("lab.server=[\"{}\"]", address(n))};
  };
  auto first = serve(0, {});
  auto simulation = start("simulation", client(0));
  EXPECT_TRUE(sees("simulation", client(0)));
  EXPECT_FALSE(sees("simulation", client(1), "1")) << "there is no second server yet";
  auto second = serve(1, {"--link", address(0)});
  EXPECT_TRUE(sees("simulation", client(1)));
  EXPECT_FALSE(sees("simulation", {}, "1")) << "seen without the server";

  // The server comes and goes: who is matched stays so, and newcomers find it again.
  first.signal(SIGKILL);
  first.wait(seconds(5));
  first = serve(0, {});
  EXPECT_TRUE(sees("simulation", client(0), "20"));
  EXPECT_FALSE(simulation.exit());

  // A recorder sees topics that it does not know beforehand.
  const std::string file = (folder_ / "all.mcap").string();
  Strings record{"--output", file, "--quiet", "--duration", "3"};
  const Strings lab = lab_arguments(client(0));
  record.insert(record.end(), lab.begin(), lab.end());
  EXPECT_EQ(run("prehend-record", record, 30).exit_code, 0);
  const Answer info = run("prehend-recording", {"info", file, "--json"}, 10);
  EXPECT_NE(info.output.find("\"robot/state\""), std::string::npos) << info.output << info.log;

  const Answer alone =
      run("prehend", {"discovery-server", "--listen", address(0), "--link", address(0)}, 10);
  EXPECT_EQ(alone.exit_code, 3);
}

// A container that is started again has another address under the same name.
TEST_F(Profiles, ADiscoveryServerIsFoundAgainByItsName) {
  if (!may_make_namespaces()) GTEST_SKIP() << "a network namespace needs root";
  const Answer answer = alone(R"sh(
ip link set lo up
hosts=$(mktemp)
mount --bind $hosts /etc/hosts
named="$lab --set lab.network=server --set lab.server=[\"post:11811\"]"
echo 127.0.0.1 post >$hosts
$bin/prehend discovery-server --listen 127.0.0.1:11811 $lab & first=$!
$bin/prehend-simulation $named & simulation=$!
trap 'kill $simulation $second || true; rm $hosts' EXIT
second=
$bin/prehend status --wait simulation --timeout 15 $named || exit 10
kill -9 $first
echo 127.0.0.2 post >$hosts
$bin/prehend discovery-server --listen 127.0.0.2:11811 $lab & second=$!
$bin/prehend status --wait simulation --timeout 20 $named || exit 11
kill -0 $simulation || exit 12
)sh",
                              60);
  EXPECT_EQ(answer.exit_code, 0) << answer.log;
}

}  // namespace
}  // namespace prehend::integration
